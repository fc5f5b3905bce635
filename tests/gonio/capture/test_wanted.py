"""Which frames a session still needs."""

import pytest

from gonio.capture import check_reach, check_space
from gonio.capture.wanted import Missing
from gonio.clock import VirtualClock
from gonio.creation import create_session
from gonio.errors import BadInputError, StorageError
from gonio.files import sha256_bytes
from gonio.journal import FrameRecord
from gonio.notes import Notes
from gonio.rig import Rig, default_rig, default_rig_text
from planner.make import make_plan

NOTES = Notes(sample="a", orientation="b", mounting="c", operator="d")


@pytest.fixture
def plan():
    return make_plan(default_rig(), views=2, lights=1)


@pytest.fixture
def session(tmp_path, plan):
    return create_session(tmp_path / "session", plan, default_rig_text(), NOTES)


def record(session, wanted, content=b"whole"):
    """Pretend that a frame was taken."""
    path = session.raw / wanted.name
    path.write_bytes(b"whole")
    return FrameRecord(
        role=wanted.role,
        shot_index=wanted.shot_index,
        attempt=wanted.attempt,
        repeat=wanted.repeat,
        exposure_s=wanted.exposure_s,
        file=f"raw/{wanted.name}",
        sha256=sha256_bytes(content),
        flux=(1.0,) * 11,
        view_theta_deg=0,
        view_phi_deg=0,
        light_theta_deg=0,
        light_phi_deg=0,
    )


def test_a_new_session_needs_everything(session, plan):
    missing = Missing(session, session.chain(), [])
    assert len(missing.dark()) == len(missing.white()) == 4 * 4
    frames = [frame for shot in plan.shots for frame in missing.of_shot(shot)]
    assert len(frames) == 2 * 4
    names = {frame.name for frame in (*missing.dark(), *missing.white(), *frames)}
    assert len(names) == 40


def test_what_verifies_is_kept_and_the_rest_taken_again(session, plan):
    shot = plan.shots[0]
    frames = Missing(session, session.chain(), []).of_shot(shot)
    records = [
        record(session, frames[0]),
        record(session, frames[1], content=b"other"),
        record(session, frames[2]),
    ]
    (session.root / records[2].file).unlink()
    left = Missing(session, session.chain(), records).of_shot(shot)
    assert [(frame.exposure_s, frame.attempt) for frame in left] == [
        (frames[1].exposure_s, 2),
        (frames[2].exposure_s, 2),
        (frames[3].exposure_s, 1),
    ]


def test_a_retaken_frame_counts(session, plan):
    shot = plan.shots[1]
    first = Missing(session, session.chain(), []).of_shot(shot)[0]
    bad = record(session, first, content=b"other")
    again = Missing(session, session.chain(), [bad]).of_shot(shot)[0]
    assert again.name != first.name
    good = record(session, again)
    assert len(Missing(session, session.chain(), [bad, good]).of_shot(shot)) == 3


def test_a_plan_out_of_reach_is_refused_by_axis(plan):
    data = default_rig().model_dump()
    data["axis"]["view_theta"]["max_deg"] = 50.0
    with pytest.raises(BadInputError, match=r"view_theta \d+ deg.*-1 to 50 deg"):
        check_reach(make_plan(default_rig(), views=81, lights=1).shots, Rig.model_validate(data))


def test_a_disk_too_small_is_refused_before_anything_moves(tmp_path, monkeypatch):
    usage = type("Usage", (), {"free": 60_000_000})()
    monkeypatch.setattr("shutil.disk_usage", lambda _: usage)
    check_space(tmp_path / "a" / "b", 10, default_rig(), "free some")
    with pytest.raises(StorageError, match=r"needs 0\.10 GB.*; free some"):
        check_space(tmp_path / "a" / "b", 1000, default_rig(), "free some")


def test_journal_and_frames_survive_reopening(session, plan):
    with session.journal(writing=True) as journal:
        frame = record(session, Missing(session, session.chain(), []).of_shot(plan.shots[0])[0])
        journal.append_frame(VirtualClock(3.0), frame)
    with session.journal() as journal:
        assert journal.frames() == [frame]
