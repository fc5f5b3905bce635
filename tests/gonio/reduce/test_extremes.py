"""Frames at the edge of what can be measured: a right value, a flag, or one clear line."""

import struct

import numpy as np
import pytest

from gonio.checks import Checks
from gonio.errors import BadInputError
from gonio.samples import Flag
from nnbrdf.analytic import Lambert
from sim import sensor
from sim.dng import dng_bytes

from .conftest import SMALL_RIG, Flat, reduced, with_pixels

TWO = [(20, 0, 40, 90), (50, 10, 30, 200)]
SECOND = {"light_theta": 50, "light_phi": 10, "view_theta": 30, "view_phi": 200}
GREY = Lambert((0.4, 0.4, 0.4))


def is_right(samples, brdf):
    off = np.abs(samples.value - brdf)
    return bool((off < 4 * samples.sigma).all())


def test_all_pixels_saturated(photographer):
    shots = photographer(TWO, Flat(100.0), exposures_s=(0.2,), rig_text=SMALL_RIG)
    samples, checks = reduced(shots.calibrate().shoot())
    assert (samples.flag & Flag.CLIPPED).all()
    assert (samples.value < 100).all()
    assert (checks["saturation"].shots, checks["saturation"].retake) == ((0, 1), False)


def test_nothing_above_the_noise(photographer):
    shots = photographer(TWO, Flat(0.0), exposures_s=(0.2,), rig_text=SMALL_RIG)
    samples, checks = reduced(shots.calibrate().shoot())
    assert np.abs(samples.value / samples.sigma).max() < 4
    assert set(checks["noise"].shots) <= {0, 1}
    assert (samples.flag & Flag.FAINT).any()
    assert checks["negative"].ok


@pytest.mark.parametrize(
    ("brdf", "exposures_s", "lamps"),
    [(1e-4, (0.2, 2.0, 20.0), range(1, 12)), (1e4, (1e-5, 1e-4, 0.2), (1,))],
    ids=["black", "mirror-like"],
)
def test_from_black_to_mirror_like(photographer, brdf, exposures_s, lamps):
    shots = photographer(
        TWO, Flat(brdf), exposures_s=exposures_s, lamps=lamps, rig_text=SMALL_RIG, seed=3
    )
    samples, _ = reduced(shots.calibrate().shoot())
    assert is_right(samples, brdf)
    assert (samples.sigma < 0.1 * brdf).all()


def test_grazing_views(photographer):
    pairs = [(20, 0, 89, 0), (20, 0, 40, 0)]
    shots = photographer(pairs, GREY, exposures_s=(0.2,)).calibrate().shoot()
    samples, checks = reduced(shots)
    assert samples.shot_index.tolist() == [1]
    assert checks["complete"].shots == (0,)
    samples, _ = reduced(shots, "--patch-mm", "60")
    assert samples.shot_index.tolist() == [0, 1]
    assert is_right(samples, 0.4 / np.pi)


def test_a_sample_that_fills_three_pixels(photographer):
    text = SMALL_RIG.replace("focal_px = 4000.0", "focal_px = 100.0")
    shots = photographer(TWO, GREY, exposures_s=(0.02, 0.2), rig_text=text).calibrate().shoot()
    with pytest.raises(BadInputError, match="too few pixels; use a larger --patch-mm"):
        reduced(shots)
    samples, _ = reduced(shots, "--patch-mm", "70")
    assert (samples.flag & Flag.FEW_PIXELS).all()
    assert is_right(samples, 0.4 / np.pi)


@pytest.mark.parametrize("lit", [(), range(2, 12)], ids=["all lamps", "one lamp"])
def test_dead_lamps(photographer, lit):
    shots = photographer(TWO, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate().shoot()
    shots.take("shot", SECOND, 0.2, index=1, attempt=2, lamps=lit)
    samples, checks = reduced(shots)
    assert checks["lamps"].shots == (1,)
    assert checks["lamps"].retake
    assert is_right(samples, 0.4 / np.pi)
    assert samples.shot_index.tolist() == ([0, 1] if lit else [0])
    assert (samples.flag[-1] & Flag.SUSPECT).all() == bool(lit)
    (suspect,) = Checks.load(shots.session.checks_path).suspects
    assert suspect.files == ("raw/shot_000001_0.2_r0_a2.dng",)


@pytest.mark.parametrize("black", [0, 1020])
def test_another_black_level_in_a_file_is_refused(photographer, black):
    shots = photographer(TWO, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate().shoot()

    def of_another(data):
        was, becomes = (struct.pack("<HHII", 50714, 4, 1, level) for level in (1024, black))
        assert data.count(was) == 1
        return data.replace(was, becomes)

    shots.take("shot", SECOND, 0.2, index=1, attempt=2, change=of_another)
    samples, checks = reduced(shots)
    assert checks["complete"].ok
    # the older try counts
    assert samples.attempt.tolist() == [1, 1]


def brighter(mosaic):
    return mosaic + 300


def one_bit_flipped(mosaic):
    changed = mosaic.astype(np.uint16)
    changed[20, 20] ^= 1 << 14
    return changed


@pytest.mark.parametrize("change", [brighter, one_bit_flipped])
def test_what_a_file_hides_shows_between_exposures(photographer, change):
    shots = photographer(TWO, GREY, exposures_s=(0.02, 0.2), rig_text=SMALL_RIG)
    shots.calibrate().shoot()
    shots.take("shot", SECOND, 0.02, index=1, attempt=2, change=with_pixels(change, 40))
    _, checks = reduced(shots)
    assert checks["exposures"].shots == (1,)
    assert checks["exposures"].retake


def test_a_bit_flipped_since(photographer):
    shots = photographer(TWO, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate().shoot()
    path = shots.session.raw / "shot_000001_0.2_r0_a1.dng"
    data = bytearray(path.read_bytes())
    data[-1000] ^= 1
    path.write_bytes(data)
    samples, checks = reduced(shots)
    assert samples.shot_index.tolist() == [0]
    assert checks["complete"].shots == (1,)
    assert Checks.load(shots.session.checks_path).suspects == ()  # a resume takes it again


@pytest.mark.parametrize("bits", [14, 16])
@pytest.mark.parametrize("cfa", ["RGGB", "BGGR", "GRBG", "GBRG"])
def test_every_order_of_filters_and_depth(photographer, monkeypatch, cfa, bits):
    color = Lambert((0.6, 0.3, 0.1))
    white = 2**bits - 1
    black = 1024 >> (16 - bits)
    monkeypatch.setattr(sensor, "CFA", cfa)
    monkeypatch.setattr(sensor, "BLACK_LEVEL", black)
    monkeypatch.setattr(sensor, "WHITE_LEVEL", white)
    monkeypatch.setattr(sensor, "GAIN", (white - black) / sensor.FULL_WELL_E)
    shots = photographer(TWO, color, exposures_s=(0.02, 0.2), rig_text=SMALL_RIG, seed=2)
    samples, checks = reduced(shots.calibrate().shoot(), "--patch-mm", "12")
    assert is_right(samples, np.array(color.color) / np.pi)
    assert all(check.ok for check in checks.values())


@pytest.mark.parametrize(("width", "height"), [(41, 40), (40, 43), (39, 41)])
def test_odd_sizes(photographer, width, height):
    text = SMALL_RIG.replace("width = 40", f"width = {width}").replace(
        "height = 40", f"height = {height}"
    )
    shots = photographer(TWO, GREY, exposures_s=(0.2,), rig_text=text).calibrate().shoot()
    samples, _ = reduced(shots, "--patch-mm", "12")
    assert is_right(samples, 0.4 / np.pi)


def of_another_camera(_):
    return dng_bytes(
        np.full((40, 42), 9000, np.uint16), black=1024, white=65535, exposure_s=0.2, iso=100,
        color_matrix=sensor.CAMERA_FROM_XYZ, as_shot_neutral=sensor.CAMERA_NEUTRAL,
        camera_model="other", unique_id="0" * 32,
    )  # fmt: skip


def without_exposure_time(data):
    return data.replace(bytes([0x9A, 0x82]), bytes([0x9B, 0x82]), 1)


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (of_another_camera, "is unlike most frames: its width is 42, not 40"),
        (without_exposure_time, "states no ExposureTime"),
    ],
    ids=["another camera's size", "no exposure tag"],
)
def test_what_cannot_be_a_frame_of_this_session(photographer, change, problem):
    shots = photographer(TWO, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate()
    shots.shoot(change=change)
    with pytest.raises(BadInputError, match="none of the 2 shots can be used") as caught:
        reduced(shots)
    assert problem in str(caught.value)
    assert "\n" not in str(caught.value)
