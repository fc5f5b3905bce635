"""Whole sessions of real DNG files, reduced; the twin's materials are the truth."""

import logging
from dataclasses import dataclass

import cv2
import numpy as np
import pytest

from gonio.clock import VirtualClock
from gonio.directions import paper_directions
from gonio.errors import BadFileError, BadInputError
from gonio.materials import MeasuredTable
from gonio.reduce import reduce_session
from gonio.samples import Flag, Samples
from nnbrdf.analytic import Lambert
from sim.dng import dng_bytes
from sim.materials import load_material
from sim.sensor import CAMERA_FROM_XYZ

from .conftest import SMALL_RIG, WHITE_DEG

HEMISPHERE = [(light, 20, view, 130) for light in (0, 30, 75) for view in (0, 45, 75)]
ONE = [(20, 0, 40, 90)]
TWO = [(20, 0, 40, 90), (50, 10, 30, 200)]
GREY = Lambert((0.4, 0.4, 0.4))


def errors(samples, material):
    return samples.value - material.evaluate(samples.light, samples.view)


@pytest.mark.parametrize(
    "material",
    [GREY, Lambert((0.7, 0.2, 0.03)), load_material("wood-veneer")],
    ids=["grey", "saturated color", "wood"],
)
def test_the_material_comes_back_from_all_directions(photographer, material):
    shots = photographer(HEMISPHERE, material, exposures_s=(0.02, 0.2, 2.0), seed=5)
    samples = reduce_session(shots.calibrate().shoot().session)
    z = errors(samples, material) / samples.sigma
    assert np.abs(z).max() < 3.5
    known = material.evaluate(samples.light, samples.view)
    # all shots share the white's error, of the order of 0.3 %, more in blue
    np.testing.assert_allclose(samples.value.mean(axis=0), known.mean(axis=0), rtol=0.01, atol=3e-4)
    assert not (samples.flag & (Flag.CLIPPED | Flag.FAINT)).any()


def test_directions_are_the_encoders(photographer):
    shots = photographer([(20, 0, 40, 90)], GREY, exposures_s=(0.2,), rig_text=SMALL_RIG)
    samples = reduce_session(shots.calibrate().shoot().session)
    record = shots.journal.frames()[-1]
    for side in ("light", "view"):
        direction = getattr(samples, side)[0]
        theta_deg = np.degrees(np.arccos(direction[2]))
        assert theta_deg == pytest.approx(getattr(record, f"{side}_theta_deg"), abs=0.01)
        assert theta_deg != pytest.approx({"light": 20, "view": 40}[side], abs=1e-4)


def test_a_few_lamps_are_measured_against_all_of_them(photographer):
    shots = photographer(TWO, GREY, exposures_s=(0.2, 2.0), lamps=(2, 3, 4), seed=1)
    samples = reduce_session(shots.calibrate().shoot().session)
    np.testing.assert_allclose(samples.value, 0.4 / np.pi, rtol=0.02)
    assert samples.light_solid_angle[0] < 1e-5
    # lamps 2 to 4 are 10.6 mm right and 7.7 mm up of the centre
    record = shots.journal.frames()[-1]
    theta_deg = np.degrees(np.arccos(samples.light[-1, 2]))
    assert theta_deg == pytest.approx(record.light_theta_deg - np.degrees(7.7 / 2000), abs=0.02)


def test_the_shutter_s_true_time_counts(photographer):
    # it is up to 50 us late, a tenth of this exposure
    pairs = [(20, 0, 0, phi) for phi in (0, 60, 120, 180)]
    shots = photographer(pairs, GREY, exposures_s=(5e-4,), seed=1).calibrate().shoot()
    samples = reduce_session(shots.session, patch_mm=60)
    assert (samples.sigma[:, 1] / samples.value[:, 1] < 0.01).all()
    assert np.abs(errors(samples, GREY) / samples.sigma).max() < 3.5


def test_sigma_is_honest(photographer):
    color = Lambert((0.6, 0.3, 0.05))
    pairs = [(0, 0, 45, 10), (30, 10, 60, 200), (60, 100, 75, 30), (75, 0, 0, 0)]
    z = []
    for seed in range(12):
        shots = photographer(pairs, color, exposures_s=(0.02, 0.2), seed=seed, rig_text=SMALL_RIG)
        samples = reduce_session(shots.calibrate().shoot().session)
        z.append(errors(samples, color) / samples.sigma)
    assert 0.8 < np.std(z) < 1.25
    assert abs(np.mean(z)) < 0.2


def test_a_highlight_beyond_all_exposures_is_flagged_and_bounded(photographer):
    mirror = load_material("near-mirror")
    pairs = [(30, 0, 30, 180), (30, 0, 60, 90)]
    shots = photographer(pairs, mirror, exposures_s=(0.2, 2.0)).calibrate().shoot()
    samples = reduce_session(shots.session)
    assert (samples.flag[0] & Flag.CLIPPED).all()
    assert not (samples.flag[1] & Flag.CLIPPED).any()
    known = mirror.evaluate(samples.light, samples.view)
    assert (samples.value[0] < known[0]).all()
    # white fills half the well in 0.2 s: the bound is some twice its value, and has no color cast
    np.testing.assert_allclose(samples.value[0], samples.value[0, 1])
    assert samples.value[0, 1] == pytest.approx(2 * 0.315 / np.cos(np.pi / 6), rel=0.05)


def test_short_exposures_resolve_a_highlight(photographer):
    mirror = load_material("near-mirror")
    pairs = [(30, 0, 30, 180)]
    shots = photographer(pairs, mirror, exposures_s=(2e-4, 0.02, 0.2)).calibrate().shoot()
    samples = reduce_session(shots.session)
    assert not (samples.flag & Flag.CLIPPED).any()
    known = mirror.evaluate(samples.light, samples.view)
    np.testing.assert_allclose(samples.value, known, rtol=0.2)


def test_black_is_faint(photographer):
    shots = photographer(ONE, Lambert((0.0, 0.0, 0.0)), exposures_s=(0.2,), seed=2)
    samples = reduce_session(shots.calibrate().shoot().session)
    assert (samples.flag & Flag.FAINT).any()
    assert np.abs(samples.value / samples.sigma).max() < 3


def test_few_pixels_are_flagged_by_channel(photographer):
    shots = photographer([(0, 0, 75, 0), (0, 0, 0, 0)], GREY, exposures_s=(0.2,))
    samples = reduce_session(shots.calibrate().shoot().session, patch_mm=5)
    assert (samples.flag[0] & Flag.FEW_PIXELS).tolist() == [Flag.FEW_PIXELS, 0, Flag.FEW_PIXELS]
    assert not samples.flag[1].any()


def test_the_file_is_what_was_returned_and_says_what_it_was_made_from(photographer):
    shots = photographer(TWO, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate().shoot()
    samples = reduce_session(shots.session)
    stored = Samples.load(shots.session.samples_path)
    np.testing.assert_array_equal(stored.value, samples.value)
    assert stored.color_space == "linear sRGB"
    assert stored.provenance["plan"] == shots.plan.sha256
    assert stored.provenance["rig"] == shots.rig.sha256
    assert len(stored.provenance["frames"]) == 64
    first = shots.session.samples_path.read_bytes()
    reduce_session(shots.session)
    assert shots.session.samples_path.read_bytes() == first


def test_progress_counts_shots(photographer):
    shots = photographer(TWO, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate().shoot()
    seen = []
    reduce_session(shots.session, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(1, 2), (2, 2)]


def test_a_larger_patch_is_surer(photographer):
    shots = photographer(ONE, GREY, exposures_s=(0.2,)).calibrate().shoot()
    small = reduce_session(shots.session, patch_mm=5)
    large = reduce_session(shots.session, patch_mm=20)
    assert (large.sigma < 0.4 * small.sigma).all()
    assert large.view_solid_angle == pytest.approx(16 * small.view_solid_angle)
    np.testing.assert_allclose(large.value, 0.4 / np.pi, rtol=0.01)


POSE = {"light_theta": 20, "light_phi": 0, "view_theta": 40, "view_phi": 90}


class TestAttempts:
    @pytest.fixture
    def shots(self, photographer):
        shots = photographer(ONE, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG)
        return shots.calibrate().shoot()

    def test_the_newest_counts(self, shots):
        first = reduce_session(shots.session)
        shots.take("shot", POSE, 0.2, attempt=2)
        second = reduce_session(shots.session)
        assert (first.attempt, second.attempt) == ([1], [2])
        assert (first.value != second.value).all()
        assert first.provenance["frames"] != second.provenance["frames"]

    def test_an_invalid_one_does_not(self, shots):
        first = reduce_session(shots.session)
        shots.take("shot", POSE, 0.2, attempt=2).unlink()
        second = reduce_session(shots.session)
        assert second.attempt == [1]
        np.testing.assert_array_equal(second.value, first.value)


def cut(data):
    return data[:-1000]


def jpeg(_):
    done, data = cv2.imencode(".jpg", np.zeros((40, 40, 3), np.uint8))
    assert done
    return data.tobytes()


@dataclass(frozen=True)
class Other:
    """A good DNG, but not of this camera, or not of this exposure."""

    size: int = 40
    iso: int = 100
    cfa: str = "RGGB"
    exposure_s: float = 0.2

    def __call__(self, _):
        return dng_bytes(
            np.full((self.size, self.size), 5000, np.uint16), cfa=self.cfa, black=1024,
            white=65535, exposure_s=self.exposure_s, iso=self.iso, color_matrix=CAMERA_FROM_XYZ,
            as_shot_neutral=(0.5, 1, 0.6), camera_model="other", unique_id="0" * 32,
        )  # fmt: skip


TAKEN_BADLY = {
    "truncated": (cut, "is cut short, by 1000 bytes"),
    "a JPEG renamed": (jpeg, "is not a DNG"),
    "of another size": (Other(size=42), "is unlike most frames: its width is 42, not 40"),
    "of another pattern": (Other(cfa="BGGR"), "is unlike most frames: its filter pattern is BGGR"),
    "at another ISO": (Other(iso=400), "is unlike most frames: its ISO is 400, not 100"),
    "of another exposure": (Other(exposure_s=0.02), "was open 0.02 s, not the 0.2 s asked for"),
}


@pytest.mark.parametrize(("change", "problem"), TAKEN_BADLY.values(), ids=TAKEN_BADLY)
def test_a_shot_that_was_taken_badly_is_left_out(photographer, caplog, change, problem):
    shots = photographer(TWO, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate().shoot()
    pose = {"light_theta": 50, "light_phi": 10, "view_theta": 30, "view_phi": 200}
    bad = shots.take("shot", pose, 0.2, index=1, attempt=2, change=change)
    (shots.session.raw / "shot_000001_0.2_r0_a1.dng").unlink()
    with caplog.at_level(logging.WARNING):
        samples = reduce_session(shots.session)
    assert samples.shot_index.tolist() == [0]
    (message,) = caplog.messages
    assert f"1 of 2 shots left out, the first because of {bad}: {problem}" in message


def test_a_first_frame_that_is_the_odd_one_goes_alone(photographer, caplog):
    shots = photographer(TWO, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG)
    odd = shots.take("dark", WHITE_DEG, 0.2, repeat=9, lamps=(), change=Other(iso=400))
    shots.calibrate().shoot()
    assert len(reduce_session(shots.session)) == 2
    assert f"1 calibration frames left out, the first because of {odd}: is unlike" in caplog.text
    # so that a resume takes it again
    rejected = shots.journal.rejected()
    assert list(rejected) == [str(odd.relative_to(shots.session.root))]


def test_where_many_frames_are_unlike_the_others_none_is_rejected(photographer):
    shots = photographer(4 * TWO, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate()
    shots.shoot(change=Other(iso=400))
    with pytest.raises(BadInputError, match="its ISO is"):
        reduce_session(shots.session)
    assert not shots.journal.rejected()


def test_a_rig_file_with_another_size_costs_no_frame(photographer):
    other = SMALL_RIG.replace("width = 40", "width = 44")
    assert other != SMALL_RIG
    shots = photographer(ONE, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate().shoot()
    shots.session.rig_path.write_text(other)
    with pytest.raises(BadInputError, match=r"is 40 x 40 px, not 44 x 40 as in rig\.toml"):
        reduce_session(shots.session)
    assert not shots.journal.rejected()


def flip_a_bit(path):
    data = bytearray(path.read_bytes())
    data[-500] ^= 1
    path.write_bytes(data)


def cut_short(path):
    path.write_bytes(path.read_bytes()[:-1])


@pytest.mark.parametrize("damage", [flip_a_bit, cut_short, lambda path: path.unlink()])
def test_a_shot_that_was_damaged_since_is_left_out(photographer, caplog, damage):
    shots = photographer(TWO, GREY, exposures_s=(0.02, 0.2), rig_text=SMALL_RIG)
    shots.calibrate().shoot()
    whole = reduce_session(shots.session)
    damage(shots.session.raw / "shot_000000_0.02_r0_a1.dng")
    samples = reduce_session(shots.session)
    assert samples.shot_index.tolist() == [1]
    np.testing.assert_array_equal(samples.value[0], whole.value[1])
    assert "1 of 2 shots left out" in caplog.text


def test_a_capture_that_was_stopped_gives_what_is_there(photographer, caplog):
    shots = photographer(TWO, GREY, exposures_s=(0.02, 0.2), rig_text=SMALL_RIG).calibrate()
    shots.take("shot", POSE, 0.02, index=0)
    shots.take("shot", POSE, 0.2, index=0)
    shots.take("shot", POSE, 0.02, index=1)
    assert reduce_session(shots.session).shot_index.tolist() == [0]
    assert "1 of 2 shots left out, the first because of shot 1: no frame of 0.2 s" in caplog.text


def test_calibration_frames_that_are_damaged_are_left_out(photographer, caplog):
    shots = photographer(ONE, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate().shoot()
    flip_a_bit(shots.session.calibration / "white_000000_0.2_r1_a1.dng")
    (shots.session.calibration / "dark_000000_0.2_r3_a1.dng").unlink()
    samples = reduce_session(shots.session)
    assert "2 calibration frames left out, the first because of" in caplog.text
    np.testing.assert_allclose(samples.value, 0.4 / np.pi, rtol=0.03)


NO_SAMPLES = {
    "nothing captured": ({}, None, "no shot has been captured yet"),
    "no white": ({"whites": 0}, None, "there is no valid white frame; take it again"),
    "no dark": ({"darks": 0}, None, "0 of at least 2 valid dark frames of 0.2 s are there; take"),
    "white too alone": ({"whites": 1}, None, "two repeats that are bright"),
    "no frame left": ({}, "raw/*", "none of the 1 shots can be used, the first because of"),
    "whites damaged": ({}, "calibration/white*", "no valid white frame ("),
    "darks damaged": ({}, "calibration/dark*", "0 of at least 2 valid dark frames of 0.2 s are"),
}


@pytest.mark.parametrize(("calibrate", "lost", "problem"), NO_SAMPLES.values(), ids=NO_SAMPLES)
def test_a_session_without_samples_says_why(photographer, calibrate, lost, problem):
    shots = photographer(ONE, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate(**calibrate)
    if problem != "no shot has been captured yet":
        shots.shoot()
    for path in shots.session.root.glob(lost or "nothing"):
        cut_short(path)
    with pytest.raises(BadInputError) as caught:
        reduce_session(shots.session)
    assert problem in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not shots.session.samples_path.exists()


def test_a_session_without_a_journal(photographer):
    shots = photographer(ONE, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG)
    shots.session.journal_path.unlink()
    with pytest.raises(BadFileError, match=r"journal\.sqlite: no such file"):
        reduce_session(shots.session)


def test_a_journal_of_another_make(photographer):
    shots = photographer(ONE, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG)
    shots.journal.append(VirtualClock(), "frame", role="shot")
    with pytest.raises(BadFileError, match=r"journal\.sqlite: record \d+ is damaged: shot_index"):
        reduce_session(shots.session)


def test_a_failed_reduction_leaves_the_last_one(photographer):
    shots = photographer(ONE, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate().shoot()
    reduce_session(shots.session)
    before = shots.session.samples_path.read_bytes()
    cut_short(next(shots.session.raw.iterdir()))
    with pytest.raises(BadInputError):
        reduce_session(shots.session)
    assert shots.session.samples_path.read_bytes() == before


def test_a_reference_enters_by_its_own_brdf(photographer, tmp_path):
    table = tmp_path / "reference.npz"
    # at 0:45 it sends back less than at most pairs, and not as much of every color
    values = load_material("velvet").evaluate(paper_directions()[:, None], paper_directions())
    MeasuredTable.of(5.0 * values).save(table)
    rig_text = SMALL_RIG.replace("reference = 0.99", f'reference = "{table}"')
    shots = photographer(ONE, GREY, exposures_s=(0.2,), rig_text=rig_text, seed=4)
    samples = reduce_session(shots.calibrate().shoot().session)
    np.testing.assert_allclose(samples.value, 0.4 / np.pi, rtol=0.03)
