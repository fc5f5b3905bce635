"""When samples are made again, of which patch, and which frames a resume then takes again."""

import numpy as np
import pytest

from gonio.reduce import is_reduced, reduce_session, usual_patch_mm
from gonio.samples import Samples
from nnbrdf.analytic import Lambert

from .conftest import SMALL_RIG

TWO = [(20, 0, 40, 90), (50, 10, 30, 200)]
SECOND = {"light_theta": 50, "light_phi": 10, "view_theta": 30, "view_phi": 200}


@pytest.fixture
def shots(photographer):
    taken = photographer(TWO, Lambert((0.4, 0.3, 0.2)), exposures_s=(0.02, 0.2), rig_text=SMALL_RIG)
    return taken.calibrate().shoot()


def frame(shots, name):
    (path,) = shots.session.root.glob(f"*/{name}.dng")
    return path


AWAY = {
    "a shot's frame": "shot_000001_0.2_r0_a1",
    "a dark frame": "dark_000000_0.2_r3_a1",
    "a white frame": "white_000000_0.02_r2_a1",
}


@pytest.mark.parametrize("name", AWAY.values(), ids=AWAY)
def test_what_lacked_a_frame_is_made_again_when_it_is_back(shots, name):
    path = frame(shots, name)
    whole = reduce_session(shots.session)
    assert is_reduced(shots.session)
    away = path.rename(shots.session.root / "away")
    reduce_session(shots.session)
    away.rename(path)
    assert not is_reduced(shots.session)
    np.testing.assert_array_equal(reduce_session(shots.session).value, whole.value)
    assert is_reduced(shots.session)


def test_what_lacked_the_newest_try_is_made_again(shots):
    retaken = shots.take("shot", SECOND, 0.2, index=1, attempt=2)
    away = retaken.rename(shots.session.root / "away")
    assert reduce_session(shots.session).attempt.tolist() == [1, 1]
    away.rename(retaken)
    assert not is_reduced(shots.session)
    assert reduce_session(shots.session).attempt.tolist() == [1, 2]


def test_half_a_bracket_makes_no_sample_and_nothing_is_made_again_for_it(photographer):
    shots = photographer(TWO, Lambert((0.4, 0.3, 0.2)), exposures_s=(0.02, 0.2), rig_text=SMALL_RIG)
    shots.calibrate()
    for exposure_s in (0.02, 0.2):
        shots.take("shot", SECOND, exposure_s, index=0)
    shots.take("shot", SECOND, 0.02, index=1)
    assert len(reduce_session(shots.session)) == 1
    assert is_reduced(shots.session)
    shots.take("shot", SECOND, 0.2, index=1)
    assert not is_reduced(shots.session)


def test_samples_of_another_plan_or_none_are_not_what_is_there(shots):
    assert not is_reduced(shots.session)
    reduce_session(shots.session)
    shots.session.samples_path.write_bytes(b"broken")
    assert not is_reduced(shots.session)


def test_the_patch_that_was_asked_for_is_kept(shots):
    assert reduce_session(shots.session).patch_mm == usual_patch_mm(shots.rig.camera)
    wide = reduce_session(shots.session, patch_mm=12.0)
    assert Samples.load(shots.session.samples_path).patch_mm == 12.0
    again = reduce_session(shots.session)
    assert again.patch_mm == 12.0
    np.testing.assert_array_equal(again.value, wide.value)
    shots.session.samples_path.unlink()
    assert reduce_session(shots.session).patch_mm == usual_patch_mm(shots.rig.camera)


def rejected(shots):
    return shots.journal.rejected()


CHANGED = {
    "missing": lambda path: path.unlink(),
    "changed": lambda path: path.write_bytes(path.read_bytes()[:-1]),
    "a folder": lambda path: (path.unlink(), path.mkdir()),
}


@pytest.mark.parametrize("change", CHANGED.values(), ids=CHANGED)
@pytest.mark.parametrize("name", AWAY.values(), ids=AWAY)
def test_a_frame_that_may_come_back_is_not_rejected(shots, name, change):
    change(frame(shots, name))
    reduce_session(shots.session)
    assert rejected(shots) == set()


def test_a_frame_as_it_was_taken_and_yet_of_no_use_is_rejected(shots):
    bad = shots.take("shot", SECOND, 0.2, index=1, attempt=2, change=lambda data: data[:-1000])
    dark = shots.take(
        "dark", SECOND, 0.2, repeat=9, lamps=(), change=lambda data: data.replace(b"II*", b"???")
    )
    assert reduce_session(shots.session).attempt.tolist() == [1, 1]
    names = {str(path.relative_to(shots.session.root)) for path in (bad, dark)}
    assert rejected(shots) == names
    # what is known to be useless is not hoped for again
    assert is_reduced(shots.session)
