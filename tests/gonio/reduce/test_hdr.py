"""Brackets merged pixel by pixel, from DNG files of known radiance."""

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gonio.calibration import Linearity
from gonio.reduce import hdr
from gonio.reduce.hdr import Exposed, Pixels, merge_pixels
from gonio.reduce.raw import decode_raw
from sim import sensor
from sim.dng import dng_bytes

EXPOSURES_S = (0.002, 0.02, 0.2, 2.0)
SIDE = 64
READ = (sensor.GAIN * sensor.READ_NOISE_E) ** 2


def photograph(electrons_per_s, exposure_s, random, path):
    """Write what the twin's sensor makes of known light as a DNG, and read it back."""
    electrons = sensor.count(electrons_per_s * exposure_s, random)
    path.write_bytes(
        dng_bytes(
            sensor.read_out(electrons, random),
            black=sensor.BLACK_LEVEL,
            white=sensor.WHITE_LEVEL,
            exposure_s=exposure_s,
            iso=100,
            color_matrix=sensor.CAMERA_FROM_XYZ,
            as_shot_neutral=sensor.CAMERA_NEUTRAL,
            camera_model="test",
            unique_id="0" * 32,
        )
    )
    return decode_raw(path.read_bytes(), path, "none")


def merged(electrons_per_s, exposures_s, seed):
    random = np.random.default_rng(seed)
    with tempfile.TemporaryDirectory() as folder:
        frames = [
            photograph(electrons_per_s, s, random, Path(folder) / "frame.dng") for s in exposures_s
        ]
    bracket = [
        Exposed(
            mosaic=frame.mosaic,
            dark=np.full(frame.mosaic.shape, sensor.BLACK_LEVEL, np.float32),
            exposure=frame.exposure_s,
            read_variance=READ,
        )
        for frame in frames
    ]
    return merge_pixels(bracket, Pixels(sensor.GAIN, frames[0].sensor.saturation))


@settings(max_examples=15)
@given(seed=st.integers(0, 10**6), lowest=st.floats(5.0, 20.0))
def test_six_decades_of_light_come_back_with_their_sigma(seed, lowest):
    span = 10 ** np.random.default_rng(seed).uniform(0, 6, (SIDE, SIDE))
    span.flat[:2] = 1.0, 1e6
    light = lowest * span
    told = merged(light, EXPOSURES_S, seed)
    assert not told.clipped.any()
    off = told.value / sensor.GAIN - light
    score = off / (np.sqrt(told.variance) / sensor.GAIN)
    # 4096 pixels: one standard error of the mean is 0.016, of the deviation 0.011
    assert abs(score.mean()) < 0.08
    assert score.std() == pytest.approx(1.0, abs=0.06)
    # 1.5 % at worst where at least 4500 electrons were gathered, six sigma off
    bright = light > 1e4
    assert np.abs(off[bright] / light[bright]).max() < 0.09


BENDING = Linearity(coefficients=(0.01, 0.05), raw_range=64_000, reach=0.9, deviation=0.0, left=0.0)


@pytest.mark.parametrize("kernel", [True, False])
def test_saturated_pixels_have_no_weight(kernel, monkeypatch):
    if not kernel:
        monkeypatch.setattr(hdr, "_pixels", None)
    one = [_frame(20_000, 0.5), _frame(40_000, 1.0)]
    alone, beside = (
        merge_pixels(bracket, Pixels(1.0, 60_000)) for bracket in (one, [*one, _frame(64_000, 5.0)])
    )
    np.testing.assert_array_equal(alone.value, beside.value)
    np.testing.assert_array_equal(alone.variance, beside.variance)
    np.testing.assert_allclose(alone.value, 40_000)


@pytest.mark.parametrize("kernel", [True, False])
def test_saturated_in_every_exposure_is_a_bound_that_nobody_weighs(kernel, monkeypatch):
    if not kernel:
        monkeypatch.setattr(hdr, "_pixels", None)
    told = merge_pixels([_frame(63_000, 1.0), _frame(61_000, 0.1)], Pixels(1.0, 60_000))
    assert told.clipped.all()
    np.testing.assert_allclose(told.value, 610_000.0)


@pytest.mark.skipif(hdr._pixels is None, reason="the kernel was not compiled")
@settings(max_examples=20)
@given(seed=st.integers(0, 10**6), bends=st.booleans(), answers=st.booleans())
def test_the_kernel_says_what_numpy_says(seed, bends, answers):
    random = np.random.default_rng(seed)
    shape = (5, 519)
    bracket = [
        Exposed(
            random.integers(900, 65535, shape).astype(np.uint16),
            random.uniform(900, 1100, shape).astype(np.float32),
            exposure,
            12.0,
            (1.0, 20.0, 300.0, -4.0),
        )
        for exposure in (0.1, 1.0, 10.0)
    ]
    response = random.uniform(0.5, 1.0, shape).astype(np.float32)
    response[random.random(shape) < 0.01] = np.nan
    pixels = Pixels(1.1, 60_000, BENDING if bends else None, response if answers else None)
    one = merge_pixels(bracket, pixels)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(hdr, "_pixels", None)
        other = merge_pixels(bracket, pixels)
    np.testing.assert_allclose(one.value, other.value, rtol=1e-4, atol=1.0)
    np.testing.assert_allclose(one.variance, other.variance, rtol=1e-3)


def _frame(signal, exposure):
    return Exposed(np.full((1, 1), signal, np.uint16), np.zeros((1, 1), np.float32), exposure, READ)
