"""The last file of a shot comes while the arms move on; what counts is safe, whatever happens."""

import pytest

from gonio.devices import Arm, LampHead
from gonio.errors import DeviceFaultError
from planner.make import make_plan


def plan_of(rig):
    return make_plan(rig, views=3, lights=3)


@pytest.mark.parametrize(("slow", "each_s"), [(False, 0.04), (True, 1.7)], ids=["twin", "slow"])
def test_overlapped_is_quicker_by_a_read_out_for_each_shot(stage, request, slow, each_s):
    if slow:
        request.getfixturevalue("slow_camera")
    overlapped = stage(plan_of)
    overlapped.run()
    request.getfixturevalue("serial_order")
    one_by_one = stage(plan_of)
    one_by_one.run()
    assert overlapped.shots() == one_by_one.shots()
    # 8 shots are followed by a move, and the dark frames by the lighting of the lamps
    saved_s = one_by_one.took_s - overlapped.took_s
    assert saved_s / 9 == pytest.approx(each_s, rel=0.3)
    # and that is what the first foretells of the other
    assert overlapped.usage().hidden_s == pytest.approx(saved_s, rel=0.25)
    assert overlapped.usage().utilisation > one_by_one.usage().utilisation
    assert one_by_one.usage().hidden_s == pytest.approx(0.0, abs=0.01)


def test_a_file_is_vouched_for_while_the_arms_are_on_their_way(stage, slow_camera):
    here, came = stage(plan_of), []

    def look_in(twin, instrument):
        settle = instrument.arm.settle

        def and_look(angles_deg):
            came.append(len(here.shots()))
            settle(angles_deg)

        instrument.arm.settle = and_look

    here.meddle = look_in
    here.run()
    # the first two ways lead to the white reference and to shot 0; most of the others take 2 s
    on_the_way = [taken == 4 * shot for shot, taken in enumerate(came[2:], 1)]
    assert len(on_the_way) == 8
    assert sum(on_the_way) > 4


def losing_files(here, when):
    """Let files not come of exposures for which `when(exposure_s)`."""

    def lose(twin, instrument):
        expose = instrument.lamps.expose

        def meddled(exposure_s):
            twin.tether.loses_files = when(exposure_s)
            return expose(exposure_s)

        object.__setattr__(instrument.lamps, "expose", meddled)

    here.meddle = lose


def test_a_file_that_never_comes_is_exposed_again(stage):
    here, lost = stage(plan_of), []

    def once(exposure_s):
        is_hit = len(here.shots()) == 7 and not lost
        lost.extend([exposure_s] * is_hit)
        return is_hit

    losing_files(here, once)
    here.run()
    assert len(here.shots()) == len({*here.shots()}) == 9 * 4
    # the arms had moved on when it was missed, so it is the last to be taken
    assert here.shots()[-1] == (1, *lost)
    ((what, did),) = here.noted()
    assert "did not come within 10 s" in what
    assert what.endswith(f"it is shot 1, {lost[0]:g} s")
    assert did == "tried again"


def test_what_cannot_be_taken_is_left_for_a_resume(stage):
    here = stage(plan_of)

    def of_shot_5(exposure_s):
        taken = here.shots()
        return exposure_s == 2.0 and (taken[-1:] == [(5, 0.2)] or len(taken) == 35)

    losing_files(here, of_shot_5)
    with pytest.raises(DeviceFaultError, match=r"^shot 5 could not be taken") as caught:
        here.run()
    assert "did not come within 10 s" in str(caught.value)
    assert len(here.shots()) == len({*here.shots()}) == 35
    here.meddle = lambda twin, instrument: None
    here.run()
    assert here.shots()[-1] == (5, 2.0)
    assert len(here.shots()) == 36


def test_a_camera_that_gives_nothing_at_all_ends_the_capture(stage):
    here = stage(plan_of)
    losing_files(here, lambda exposure_s: len(here.shots()) >= 7)
    with pytest.raises(DeviceFaultError, match="did not come within 10 s") as caught:
        here.run()
    assert "it is shot 1, 2 s" in here.noted()[0][0]
    assert len(here.noted()) == 8
    assert "go on with" in caught.value.__notes__[-1]


def opening_the_door(here, closes_after_s):
    def open_it(twin, instrument):
        move = instrument.arm.move

        def and_open(*where):
            if len(here.shots()) == 3:
                twin.set_interlock(True)
                closes_s = here.clock.now() + closes_after_s
                here.clock.call_at(closes_s, lambda: twin.set_interlock(False))
            move(*where)

        instrument.arm.move = and_open

    here.meddle = open_it


def test_a_door_that_opens_on_the_way_is_waited_for(stage):
    here = stage(plan_of)
    opening_the_door(here, 60.0)
    here.run()
    assert len(here.shots()) == len({*here.shots()}) == 9 * 4
    assert here.took_s > 60.0
    assert [did for _, did in here.noted()] == ["tried again", "waits"]


def test_a_door_that_stays_open_ends_it_and_keeps_what_was_exposed(stage):
    here = stage(plan_of)
    opening_the_door(here, 3000.0)
    with pytest.raises(DeviceFaultError, match="interlock is open for 30 min"):
        here.run()
    # the last exposure of shot 0 was over when the arms began to move
    assert here.shots() == [(0, exposure_s) for exposure_s in (0.002, 0.02, 0.2, 2.0)]


def test_a_stop_on_the_way_loses_one_frame_that_is_taken_again(stage):
    here = stage(plan_of)
    here.run_and_stop(after=3)
    assert here.shots() == [(0, exposure_s) for exposure_s in (0.002, 0.02, 0.2)]
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
    here.run()
    assert len(here.shots()) == len({*here.shots()}) == 9 * 4
    ((what, _),) = here.noted()
    assert "lay in the camera's folder before its exposure" in what
    files = [path.read_bytes() for path in here.session.raw.iterdir()]
    assert len(files) == 9 * 4
    assert b"old" not in files


def test_a_host_that_dies_leaves_lamps_and_drives_to_their_watchdogs(stage, monkeypatch):
    here, twins = stage(plan_of), []

    def die(twin, instrument):
        twins.append(twin)
        move = instrument.arm.move

        def and_die(*where):
            if len(here.shots()) >= 3:
                raise SystemExit
            move(*where)

        instrument.arm.move = and_die

    here.meddle = die
    for end in ("try_to_stop", "stop", "release"):
        monkeypatch.setattr(Arm, end, lambda self: None)
    monkeypatch.setattr(LampHead, "off", lambda self: None)
    with pytest.raises(SystemExit):
        here.run()
    (twin,) = twins
    assert any(led.on for led in twin.lamps.leds)
    here.clock.sleep(61.0)
    twin.lamps.advance()
    assert not any(led.on for led in twin.lamps.leds)
    states = [twin.bus.read(unit, 0x0001, 1)[0] & 0x4F for unit in (1, 2, 3, 4)]
    assert states == [0x08] * 4  # fault: the watchdog took the power away
