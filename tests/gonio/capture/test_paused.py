"""A device that fails while somebody has paused: nothing moves until the pause is over."""

import pytest

from gonio.clock import SystemClock
from gonio.errors import DeviceFaultError
from gonio.wishes import forget, wish
from planner.make import make_plan

FAILS = {"arm": ("arm", "attend"), "lamps": ("lamps", "off")}


@pytest.mark.parametrize(("device", "method"), FAILS.values(), ids=FAILS)
def test_a_fault_waits_for_the_end_of_the_pause(stage, monkeypatch, device, method):
    here = stage(lambda rig: make_plan(rig, views=2, lights=2))
    root, polls, moved = here.session.root, [], []

    def fail():
        raise DeviceFaultError("view_theta: no power")

    def meddle(twin, instrument):
        driver, home, move = getattr(instrument, device), instrument.arm.home, instrument.arm.move
        kind = type(driver)

        def person(clock, seconds):
            polls.append(seconds)
            monkeypatch.setattr(kind, method, lambda self: fail())
            if len(polls) == 6:
                monkeypatch.undo()
                forget(root)

        def noting(*where):
            moved.append(len(polls))
            if len(moved) == 3:
                wish(root, "pause")
                monkeypatch.setattr(SystemClock, "sleep", person)
            move(*where)

        def homing():
            moved.append(len(polls))
            home()

        instrument.arm.home, instrument.arm.move = homing, noting

    here.meddle = meddle
    here.run()
    assert len(polls) == 6
    # before the pause and after it, but not within
    assert set(moved) == {0, 6}
    assert here.noted() == [("view_theta: no power", "tried again")]
    with here.session.journal() as journal:
        kinds = [event.kind for event in journal.events()]
    assert [kinds.count(kind) for kind in ("paused", "resumed", "finished")] == [1, 1, 1]
    assert len(here.shots()) == 4 * len(here.session.rig().camera.exposures_s)
