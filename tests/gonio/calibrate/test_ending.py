"""Where raw values end: found by what overexposes, wherever a sensor ends."""

from types import SimpleNamespace

import numpy as np
import pytest

from gonio.calibrate.ending import end_of
from gonio.cli.calibrate import notes_of
from gonio.errors import BadInputError
from nnbrdf.analytic import Lambert
from sim import sensor
from tests.calibrated_draws import calibrated_samples, imperfect_rig

BRIGHT = Lambert((0.9, 0.9, 0.9))
RANGE = sensor.WHITE_LEVEL - sensor.BLACK_LEVEL
ROWS, COLUMNS = np.indices((40, 40)) % 2
MASKS = [(row == ROWS) & (column == COLUMNS) for row, column in ((0, 0), (0, 1), (1, 1))]


DARKS = [np.full((40, 40), float(sensor.BLACK_LEVEL))] * 3


def probe(exposure_s, full_e, random, *, end=1.0):
    """A frame of an even white: 80 000 electrons a second, pixels that are full at `full_e`."""
    electrons = np.minimum(random.poisson(80_000 * exposure_s, (40, 40)), full_e)
    raw = SimpleNamespace(
        mosaic=sensor.read_out(electrons.astype(float), random, end), exposure_s=exposure_s,
        sensor=SimpleNamespace(black=sensor.BLACK_LEVEL, white=sensor.WHITE_LEVEL),
    )  # fmt: skip
    return SimpleNamespace(raw=raw, flux=(1.0,) * 11)


@pytest.mark.parametrize("share", [0.5, 0.97])
def test_a_session_on_a_sensor_that_ends_early_is_as_its_sigma_says(share):
    samples, truth, correction = calibrated_samples(
        "mild", BRIGHT, np.random.default_rng(3), camera_end=share
    )
    document = correction.document
    assert document.end_seen
    assert document.saturation == pytest.approx(sensor.BLACK_LEVEL + 0.98 * share * RANGE, abs=1)
    assert document.gain == pytest.approx(sensor.GAIN, abs=4 * document.gain_sigma)
    assert document.linearity.left < 0.004
    assert (np.abs(samples.value - truth) < 4 * samples.sigma).all()


def test_where_nothing_overexposes_the_file_is_believed_and_it_is_said():
    rig = imperfect_rig("mild", exposures_s=(0.02, 0.2))
    _, _, correction = calibrated_samples("mild", BRIGHT, np.random.default_rng(3), rig=rig)
    assert not correction.document.end_seen
    assert correction.document.saturation == pytest.approx(sensor.BLACK_LEVEL + 0.98 * RANGE)
    assert any("taken to end at WhiteLevel" in note for note in notes_of(correction.document))


@pytest.mark.parametrize("spread_e", [0.0, 300.0], ids=["alike", "each its own"])
def test_pixels_that_are_full_before_they_are_read_end_with_their_noise(spread_e):
    random = np.random.default_rng(4)
    full_e = 40_000.0 + spread_e * random.normal(size=(40, 40))
    found = end_of([probe(s, full_e, random) for s in (0.02, 0.2, 2.0)], MASKS, DARKS)
    lowest = np.percentile(full_e, 1) * sensor.GAIN
    assert found.seen
    assert found.above == pytest.approx(lowest, rel=0.003)
    # else those that are full first would count as valid
    assert found.saturation < sensor.BLACK_LEVEL + full_e.min() * sensor.GAIN


def test_a_dark_frame_is_no_end():
    random = np.random.default_rng(5)
    dark = [probe(s, 0.0, random) for s in (0.02, 2.0)]
    assert not end_of(dark, MASKS, DARKS[:2]).seen


@pytest.mark.parametrize(("bits", "offset"), [(10, 0), (14, 60)], ids=["coarse", "offset"])
def test_a_sensor_that_is_coarse_or_offset_ends_where_it_does(bits, offset):
    white, black, full_e = 2**bits - 1, 2 ** (bits - 4), 30_000.0
    scale = (white - black) / full_e

    def exposed(exposure_s, random):
        electrons = random.poisson(11_000 * exposure_s, (40, 40))
        mosaic = (black + offset + scale * electrons).round().clip(0, white).astype(np.uint16)
        raw = SimpleNamespace(
            mosaic=mosaic, exposure_s=exposure_s, sensor=SimpleNamespace(black=black, white=white)
        )
        return SimpleNamespace(raw=raw, flux=(1.0,) * 11)

    darks = [np.full((40, 40), float(black + offset))] * 3
    for seed in range(40):
        random = np.random.default_rng(seed)
        assert not end_of([exposed(s, random) for s in (0.02, 0.2, 2.0)], MASKS, darks).seen
    over = end_of([exposed(s, random) for s in (0.02, 0.2, 20.0)], MASKS, darks)
    assert (over.seen, over.above) == (True, white - black)


def test_a_reference_of_few_pixels_is_refused():
    rig = imperfect_rig("none")
    far = rig.camera.model_copy(update={"focal_px": 60.0})
    with pytest.raises(BadInputError, match="see the middle of the white reference, and 16 are"):
        calibrated_samples(
            "none", BRIGHT, np.random.default_rng(3), rig=rig.model_copy(update={"camera": far})
        )
