"""A capture that is killed for real, at any event of its journal, goes on and loses nothing."""

import shutil
import signal

import numpy as np
import pytest

from gonio.files import sha256_file
from gonio.rig import default_rig_text
from gonio.samples import Samples
from gonio.session import Session

RIG = default_rig_text().replace("[0.002, 0.02, 0.2, 2.0]", "[0.02, 0.2]")
FRAMES = 2 * (4 + 4) + 4 * 2
EVENTS = FRAMES + 3
"""The frames, that it began, that it was home and that it finished."""
# what noise is drawn
SEED = ("--seed", "2")


def ok(ended):
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def shots_of(session):
    """Return the journal's frames, in order, by what makes each the one that was wanted."""
    with session.journal() as journal:
        journal.check_chain()
        return [record.key for record in journal.frames()]


def hashes(session):
    files = (*session.calibration.glob("*.dng"), *session.raw.glob("*.dng"))
    return {path.name: sha256_file(path) for path in files}


def vouched(session):
    """Return the hashes of the frames in the journal, all of which the disk must hold."""
    if not session.journal_path.exists():
        return {}
    with session.journal() as journal:
        records = journal.frames()
    for record in records:
        assert sha256_file(session.root / record.file) == record.sha256
    return {record.file.rpartition("/")[2]: record.sha256 for record in records}


@pytest.fixture(scope="module")
def whole(forks, tmp_path_factory):
    """Return the folder of a capture that nothing stopped, without and with thermal drift."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "rig.toml").write_text(RIG)
    plan = ("--density", "2", "--criterion", "farthest", "--rig", "rig.toml", "--no-page")
    ok(forks.run(folder, "plan", *plan))
    ok(forks.run(folder, *capture("steady"), drift=False))
    ok(forks.run(folder, *capture("drifting"), *SEED))
    assert len(hashes(Session(folder / "steady"))) == FRAMES
    ok(forks.run(folder, "reduce", "drifting"))
    return folder


def capture(name):
    return ("capture", "--sim", "--plan", "plan.json", "--rig", "rig.toml", "-o", name)


def resume(name):
    return ("capture", "--sim", "--resume", "-o", name)


def some(moments, every):
    """Mark all but every so many as slow."""
    return [
        pytest.param(*moment, marks=() if number % every == 0 else pytest.mark.slow)
        for number, moment in enumerate(moments)
    ]


BEFORE = [(event, "before") for event in range(1, EVENTS + 1)]
AFTER = [(event, "after") for event in range(1, EVENTS + 1)]


# after an event is a moment before the next
@pytest.mark.parametrize(("event", "when"), some(BEFORE, 1) + some(AFTER, 5))
def test_a_kill_at_any_event_loses_nothing(forks, whole, event, when):
    session = Session(whole / f"killed-{when}-{event}")
    killed = forks.run(whole, *capture(session.root.name), kill_at=(event, when), drift=False)
    assert killed.returncode == -signal.SIGKILL
    kept = vouched(session)
    resumed = forks.run(whole, *resume(session.root.name), drift=False)
    assert (resumed.returncode, resumed.stderr) == (0, "")
    keys = shots_of(session)
    assert len(keys) == len({*keys}) == FRAMES
    # every noise is keyed, so that a resume makes the very frames that nothing would have stopped
    assert hashes(session) == hashes(Session(whole / "steady"))
    assert kept.items() <= hashes(session).items()
    shutil.rmtree(session.root)


def test_a_resume_that_is_killed_at_every_event_in_turn_gets_there(forks, whole):
    session = Session(whole / "again")
    forks.run(whole, *capture("again"), kill_at=(3, "after"), drift=False)
    for _ in range(FRAMES):
        # begun and homed come first; then one frame more each time, and the kill
        forks.run(whole, *resume("again"), kill_at=(4, "before"), drift=False)
    ok(forks.run(whole, *resume("again"), drift=False))
    keys = shots_of(session)
    assert len(keys) == len({*keys}) == FRAMES
    assert hashes(session) == hashes(Session(whole / "steady"))


@pytest.mark.parametrize("event", some([(event,) for event in range(1, EVENTS + 1)], 5))
def test_with_thermal_drift_the_values_are_the_same_within_their_sigma(forks, whole, event):
    session = Session(whole / f"drift-{event}")
    forks.run(whole, *capture(session.root.name), *SEED, kill_at=(event, "before"))
    ok(forks.run(whole, *resume(session.root.name)))
    keys = shots_of(session)
    assert len(keys) == len({*keys}) == FRAMES
    ok(forks.run(whole, "reduce", session.root.name))
    one, other = (
        Samples.load(each.samples_path) for each in (Session(whole / "drifting"), session)
    )
    np.testing.assert_array_equal(one.shot_index, other.shot_index)
    off = (one.value - other.value) / np.hypot(one.sigma, other.sigma)
    # of all events' values one in 370 is beyond 3 sigma by chance, one in 16,000 beyond 4
    assert np.abs(off).max() < 4.0
    assert np.sqrt(np.mean(off**2)) < 1.7
    shutil.rmtree(session.root)


def test_what_a_killed_capture_says_and_allows(forks, whole):
    forks.run(whole, *capture("said"), kill_at=(22, "after"))
    refused = forks.run(whole, *capture("said"))
    assert refused.returncode == 2
    assert "--resume" in refused.stderr
    ok(forks.run(whole, *resume("said")))
    assert "complete" in ok(forks.run(whole, *resume("said")))
