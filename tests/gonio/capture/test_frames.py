"""The last file of a shot comes while the arms move on; what counts is safe, whatever happens."""

import pytest

from gonio.capture.frames import FrameTaker
from gonio.errors import DeviceFaultError
from planner.make import make_plan
from sim import tether


def plan_of(rig):
    return make_plan(rig, views=3, lights=3)


def slow_camera(monkeypatch):
    """Let a file take 1.5 to 2 s, as those of real cameras do."""
    monkeypatch.setattr(tether, "_QUICKEST_S", 1.5)
    monkeypatch.setattr(tether, "_SLOWEST_S", 2.0)


def serial(monkeypatch):
    """Let every file be waited for before anything else happens."""
    take = FrameTaker.take

    def and_fetch(self, frames, folder):
        take(self, frames, folder)
        self.fetch()

    monkeypatch.setattr(FrameTaker, "take", and_fetch)


@pytest.mark.parametrize(("slow", "each_s"), [(False, 0.04), (True, 1.7)], ids=["twin", "slow"])
def test_overlapped_is_quicker_by_a_read_out_for_each_shot(stage, monkeypatch, slow, each_s):
    if slow:
        slow_camera(monkeypatch)
    overlapped = stage(plan_of)
    overlapped.run()
    serial(monkeypatch)
    one_by_one = stage(plan_of)
    one_by_one.run()
    assert overlapped.shots() == one_by_one.shots()
    # 8 shots are followed by a move, and the dark frames by the lighting of the lamps
    saved_s = one_by_one.took_s - overlapped.took_s
    assert saved_s / 9 == pytest.approx(each_s, rel=0.3)


def test_a_file_that_never_comes_loses_that_shot_alone(stage):
    here = stage(plan_of)

    def lose(twin, instrument):
        expose = instrument.lamps.expose

        def once(exposure_s):
            twin.tether.loses_files = len(here.shots()) >= 7 and exposure_s == 2.0
            return expose(exposure_s)

        object.__setattr__(instrument.lamps, "expose", once)

    here.meddle = lose
    with pytest.raises(DeviceFaultError, match="did not come within 10 s") as caught:
        here.run()
    assert "it is shot 1, 2 s" in caught.value.__notes__
    taken = here.shots()
    assert taken == [(0, e) for e in (0.002, 0.02, 0.2, 2.0)] + [(1, e) for e in (0.002, 0.02, 0.2)]
    here.meddle = lambda twin, instrument: None
    here.run()
    assert sorted(here.shots()) == sorted({*here.shots()})
    assert len(here.shots()) == 9 * 4


def test_a_fault_on_the_way_to_the_next_shot_keeps_what_was_exposed(stage):
    here = stage(plan_of)

    def trip(twin, instrument):
        move = instrument.arm.move

        def and_fail(*where):
            if len(here.shots()) >= 3:
                twin.set_interlock(True)
            move(*where)

        instrument.arm.move = and_fail

    here.meddle = trip
    with pytest.raises(DeviceFaultError, match="interlock open"):
        here.run()
    # the last exposure of shot 0 was over when the arms began to move
    assert here.shots() == [(0, exposure_s) for exposure_s in (0.002, 0.02, 0.2, 2.0)]


def test_a_stop_on_the_way_loses_one_frame_that_is_taken_again(stage):
    here = stage(plan_of)

    def interrupt(twin, instrument):
        move = instrument.arm.move

        def and_stop(*where):
            if len(here.shots()) >= 3:
                raise KeyboardInterrupt
            move(*where)

        instrument.arm.move = and_stop

    here.meddle = interrupt
    with pytest.raises(KeyboardInterrupt):
        here.run()
    assert here.shots() == [(0, exposure_s) for exposure_s in (0.002, 0.02, 0.2)]
    here.meddle = lambda twin, instrument: None
    here.run()
    assert len(here.shots()) == len({*here.shots()}) == 9 * 4


def test_a_file_of_before_the_trigger_is_never_taken(stage):
    here = stage(plan_of)

    def plant(twin, instrument):
        move = instrument.arm.move

        def and_plant(*where):
            # the number of the next exposure, while the last of the shot before is on its way
            if len(here.shots()) == 7:
                (here.folder / f"frame_{32 + 9:06d}.dng").write_bytes(b"old")
            move(*where)

        instrument.arm.move = and_plant

    here.meddle = plant
    with pytest.raises(DeviceFaultError, match="lay in the camera's folder before its exposure"):
        here.run()
    assert here.shots() == [(shot, e) for shot in (0, 1) for e in (0.002, 0.02, 0.2, 2.0)]
