"""Which wishes are left, where there is somebody to heed them."""

import pytest

from gonio.clock import VirtualClock
from gonio.creation import create_session
from gonio.notes import Notes
from gonio.rig import default_rig, default_rig_text
from gonio.watch.state import Watched
from gonio.wishes import wished
from planner.make import make_plan

NOTES = Notes(sample="a", orientation="b", mounting="c", operator="d")


@pytest.fixture(params=[{}])
def begun(tmp_path, request):
    """Return a session that a capture has begun with."""
    plan = make_plan(default_rig(), views=2, lights=2)
    session = create_session(tmp_path / "s", plan, default_rig_text(), NOTES)
    with session.lock(), session.journal(writing=True) as journal:
        journal.append(VirtualClock(), "begun", **request.param)
        yield session


def test_who_was_asked_to_stop_is_neither_paused_nor_gone_on_with(begun):
    watched = Watched(begun)
    assert [watched.want(what) for what in ("pause", "resume", "pause", "stop")] == [None] * 4
    for late in ("pause", "resume"):
        assert watched.want(late) == "the capture has been asked to stop"
        assert wished(begun.root) == "stop"


@pytest.mark.parametrize("begun", [{"by": "Bluesky"}], indirect=True)
def test_no_wish_is_left_where_nobody_heeds_one(begun):
    watched = Watched(begun)
    assert watched.state()["by"] == "Bluesky"
    assert all("Bluesky" in watched.want(what) for what in ("pause", "resume", "stop"))
    assert wished(begun.root) is None
