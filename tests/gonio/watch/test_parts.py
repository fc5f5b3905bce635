"""What is told by a journal that ends anywhere, and who may ask."""

import fcntl
import shutil
from datetime import UTC, datetime

import numpy as np
import pytest

from gonio.adaptive import rig_time
from gonio.faultlog import FaultRecord
from gonio.journal import Event
from gonio.session import Session
from gonio.watch import Access
from gonio.watch.following import Following, Told
from gonio.watch.progress import Route, progress_of


@pytest.fixture(scope="module")
def recorded(course):
    session = Session.open(course[0])
    with session.journal() as journal:
        events = list(journal.events())
        frames = [journal.frame_of(e) if e.kind == "frame" else None for e in events]
    return Route(session.chain(), session.rig()), list(zip(events, frames, strict=True))


def told_by(heard):
    told = Told()
    for event, frame in heard:
        told.hear(event, frame)
    return told


def event(number, kind, **data):
    return Event(id=number, at_s=0.0, utc=datetime.now(UTC), kind=kind, data=data)


def test_each_event_brings_a_capture_on(recorded):
    route, heard = recorded
    told, last = Told(), None
    shots = len(route.chain.shots)
    assert progress_of(route, told).marks == "n" + "w" * (shots - 1)
    for each in heard:
        told.hear(*each)
        now = progress_of(route, told)
        done = now.marks.count("d")
        assert now.marks == "d" * done + ("n" + "w" * (shots - done - 1) if done < shots else "")
        if last is not None:
            assert now.frames >= last.frames
            assert now.left_s / now.pace <= last.left_s / last.pace + 1e-9
        last = now
    assert (last.frames, last.left_s) == (route.frames, pytest.approx(0.0, abs=1e-6))
    # the twin keeps to its plan
    assert last.pace == pytest.approx(1.0, abs=0.1)


def test_a_pace_is_that_of_the_rig_and_bounded(recorded):
    route, heard = recorded
    end = max(k for k, (_, frame) in enumerate(heard) if frame) - 4
    left = progress_of(route, told_by(heard[:end]))
    for factor, pace in ((2.0, 2 * left.pace), (50.0, 3.0), (0.01, 0.5)):
        slower = [(e.model_copy(update={"at_s": factor * e.at_s}), f) for e, f in heard[:end]]
        other = progress_of(route, told_by(slower))
        assert other.pace == pytest.approx(pace)
        assert other.left_s == pytest.approx(left.left_s * pace / left.pace)


def test_a_pause_is_no_work_whatever_ends_it():
    for end in ("resumed", "stopped"):
        kinds = ["begun", "frame", "paused", end, "frame"]
        times = enumerate([0.0, 5.0, 6.0, 900.0, 907.0])
        events = [event(i, kinds[i]).model_copy(update={"at_s": at_s}) for i, at_s in times]
        assert rig_time(events) == 5.0 + 7.0


def test_a_rejected_shot_has_failed_until_it_is_next(recorded):
    route, heard = recorded
    frames = [frame for _, frame in heard if frame and frame.role == "shot"]
    for index, marks in ((3, "dddnd"), (5, "dddnd")):
        file = next(frame.file for frame in frames if frame.shot_index == index)
        rejected = (event(9999, "rejected", file=file, problem="blurred"), None)
        told = told_by([*heard, rejected])
        assert progress_of(route, told).marks[index - 3 : index + 2] == marks
    # with others waiting it comes after them
    upto = next(k for k, (_, f) in enumerate(heard) if f and f.shot_index == 8 and f.role == "shot")
    file = next(frame.file for frame in frames if frame.shot_index == 5)
    told = told_by([*heard[:upto], (event(9999, "rejected", file=file, problem="dark"), None)])
    marks = progress_of(route, told).marks
    assert (marks[:8], marks[8], set(marks[9:])) == ("dddddfdd", "n", {"w"})


def test_what_events_say(recorded):
    heard = recorded[1]
    told = told_by(heard)
    assert (told.phase, told.is_over) == ("finished", True)
    told.hear(event(1, "fault", what="camera: gone", did="tried again"))
    assert told.faults[-1][1] == FaultRecord(0.0, "camera: gone", "tried again")
    told.hear(event(2, "adaptive", until=0.05))
    assert (told.target, told.is_over) == (0.05, False)  # finished, but for this round only
    told.hear(event(3, "adaptive ended", reason="the target is reached"))
    assert (told.target, told.is_over) == (None, True)
    told.hear(event(4, "stopped", reason="as wished"))
    assert (told.phase, told.reason) == ("stopped", "as wished")


def test_a_journal_is_read_on_and_anew_when_another_lies_there(course, tmp_path, tampered):
    root = shutil.copytree(course[0], tmp_path / "s")
    following = Following(Session(root))
    first = following.look()
    count = len(first.events)
    tampered(
        root / "journal.sqlite",
        "INSERT INTO event (at_s, utc, kind, data) VALUES (9e9, ?, 'stopped', ?)",
        ("2030-01-01T00:00:00+00:00", '{"reason": "it is late"}'),
    )
    on = following.look()
    assert on is first
    assert (len(on.events), on.reason) == (count + 1, "it is late")
    shutil.copy(course[0] / "journal.sqlite", root)
    anew = following.look()
    assert (len(anew.events), anew.reason) == (count, "as wished by gonio watch")
    (root / "journal.sqlite").unlink()
    assert (following.look().phase, following.look().events) == ("waiting", [])


@pytest.mark.parametrize(
    ("served", "host", "origin", "shows", "looks", "acts"),
    [
        ("127.0.0.1", "127.0.0.1:80", None, True, True, True),
        ("127.0.0.1", "localhost:80", "http://localhost:80", True, True, True),
        ("127.0.0.1", "127.0.0.1:80", None, False, True, False),
        ("127.0.0.1", "127.0.0.1:81", None, True, False, False),
        ("127.0.0.1", "192.0.2.7:80", None, True, False, False),
        ("127.0.0.1", "evil.example:80", None, True, False, False),
        ("127.0.0.1", None, None, True, False, False),
        ("127.0.0.1", "127.0.0.1:80", "http://evil.example", True, False, False),
        ("127.0.0.1", "127.0.0.1:80", "http://127.0.0.1:81", True, False, False),
        ("127.0.0.1", "127.0.0.1:80", "null", True, False, False),
        ("::1", "[::1]:80", "http://[::1]:80", True, True, True),
        ("0.0.0.0", "192.0.2.7:80", None, True, True, True),
        ("0.0.0.0", "192.0.2.7:80", None, False, False, False),
        ("0.0.0.0", "evil.example:80", None, True, False, False),
        ("rig.example", "rig.example:80", None, True, True, True),
    ],
)
def test_who_may(served, host, origin, shows, looks, acts):
    access = Access(served, 80)
    asked = {"host": host, "origin": origin, "site": None}
    asked["token"] = access.token if shows else None
    assert (access.refusal(**asked, acts=False) is None) == looks
    assert (access.refusal(**asked, acts=True) is None) == acts
    wrong = {**asked, "token": Access(served, 80).token}
    assert access.refusal(**wrong, acts=True) is not None


def test_asking_whether_a_session_is_held_keeps_no_capture_out(course, monkeypatch):
    session = Session.open(course[0])
    assert not session.is_locked
    with session.lock():
        assert session.is_locked
    with (session.root / ".lock").open() as asking:
        fcntl.flock(asking, fcntl.LOCK_SH)
        waited = []

        def asked_meanwhile(seconds):
            waited.append(seconds)
            if len(waited) == 2:
                fcntl.flock(asking, fcntl.LOCK_UN)

        monkeypatch.setattr("gonio.session.time.sleep", asked_meanwhile)
        with session.lock():
            assert len(waited) == 2
    assert not session.is_locked


def test_routes_are_in_seconds_of_the_plan(recorded):
    route, _ = recorded
    assert np.all(route.seconds > 0)
    assert route.seconds.sum() == pytest.approx(route.chain.last.estimates.total_s)
