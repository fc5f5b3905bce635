"""The arm's driver against the twin's drives, through the transport seam."""

import math

import pytest

from gonio.capture import Instrument
from gonio.devices import AttendedClock, LocalFolder
from gonio.errors import BadInputError, DeviceFaultError, TransportLostError
from gonio.rig import AXES
from gonio.timemodel import move_time

POSE = {"view_theta": 45.0, "view_phi": 120.0, "light_theta": 15.0, "light_phi": 300.0}
ENABLED, DISABLED = 0x27, 0x40


def test_enabling_takes_one_transition_at_a_time(bench):
    bench.arm.enable()
    assert bench.states() == [ENABLED] * 4
    for unit in (1, 2, 3, 4):
        assert bench.bus.controlwords(unit) == [0x06, 0x07, 0x0F]
        assert bench.twin.bus.read(unit, 0x0003, 1) == [1]
        assert bench.twin.bus.read(unit, 0x0010, 1) == [60_000]
    assert bench.twin.bus.read(1, 0x0008, 4) == [0, 40000, 0, 40000]
    assert bench.twin.bus.read(2, 0x0008, 4) == [0, 60000, 0, 60000]


@pytest.mark.parametrize("before", [[0x06], [0x06, 0x07], [0x06, 0x07, 0x0F]])
def test_enabling_from_wherever_the_drive_is(bench, before):
    for word in before:
        bench.twin.bus.write(2, 0, [word])
    bench.arm.enable()
    assert bench.states() == [ENABLED] * 4


def test_enabling_waits_for_drives_that_boot(bench):
    for drive in bench.twin.drives.values():
        drive.power_up(bench.clock.now())
    bench.arm.enable()
    assert bench.states() == [ENABLED] * 4


def test_enabling_resets_faults_and_ends_what_was_under_way(homed):
    homed.twin.bus.write(2, 0x0004, [2, 0])
    homed.twin.bus.write(2, 0x0000, [0x1F])
    homed.clock.sleep(1.0)
    homed.twin.drives["view_phi"].control.trip(0x7500, homed.clock.now())
    homed.twin.bus.write(3, 0x0004, [0xFFFE, 0])
    homed.twin.bus.write(3, 0x0000, [0x1F])
    homed.clock.sleep(1.0)
    homed.arm.enable()
    assert homed.states() == [ENABLED] * 4
    angles = homed.arm.angles_deg()
    homed.clock.sleep(5.0)
    assert homed.arm.angles_deg() == angles


def test_homing_takes_all_axes_at_once(bench):
    bench.arm.enable()
    began = bench.clock.now()
    bench.arm.home()
    assert bench.clock.now() - began < 30.0
    for name, angle in bench.arm.angles_deg().items():
        assert angle == bench.rig.axis[name].to_degrees(0)
        assert bench.true_deg()[name] == pytest.approx(angle)


def test_axes_that_know_their_position_are_not_homed_again(homed):
    homed.arm.move(POSE)
    homed.arm.release()
    homed.arm.enable()
    began = homed.clock.now()
    homed.arm.home()
    assert homed.clock.now() - began < 0.5
    assert homed.arm.angles_deg() == pytest.approx(POSE)


def test_a_move_ends_in_position_and_still(homed):
    began = homed.clock.now()
    homed.arm.move(POSE)
    took = homed.clock.now() - began
    assert homed.true_deg() == pytest.approx(POSE, abs=0.0003)
    assert all(isinstance(angle, float) for angle in homed.arm.angles_deg().values())
    assert all(homed.twin.bus.read(unit, 0x11, 1)[0] <= 12 for unit in (1, 2, 3, 4))
    slowest = max(
        float(move_time(POSE[name] - homed.rig.axis[name].to_degrees(0), homed.rig.axis[name]))
        for name in AXES
    )
    assert slowest < took < slowest + 1.5


def test_the_axes_move_together(homed):
    homed.arm.move(dict.fromkeys(AXES, 20.0))
    began = homed.clock.now()
    homed.arm.move(dict.fromkeys(AXES, 60.0))
    assert homed.clock.now() - began < 3.0 + 1.5


def test_axes_that_are_not_named_stay(homed):
    homed.arm.move(POSE)
    homed.arm.move({"view_theta": 10.0})
    assert homed.arm.angles_deg() == pytest.approx(POSE | {"view_theta": 10.0}, abs=0.001)


def test_a_move_to_where_the_arm_is_takes_no_time(homed):
    homed.arm.move(POSE)
    began = homed.clock.now()
    homed.arm.move(POSE)
    assert homed.clock.now() - began < 0.2


def test_drives_watch_over_the_host_closely_while_they_move(homed):
    homed.at(0.5, lambda: watched.extend(drive.control.watchdog_ms for drive in drives))
    watched, drives = [], homed.twin.drives.values()
    homed.arm.move(POSE)
    assert watched == [3000] * 4
    AttendedClock(homed.clock, homed.arm.attend).sleep(1000.0)
    assert homed.states() == [ENABLED] * 4
    homed.clock.sleep(61.0)  # as a host that died
    assert ENABLED not in homed.states()


def test_a_host_that_dies_leaves_no_axis_moving(homed):
    def die(_):
        raise KeyboardInterrupt

    homed.bus.plan = {80: die}
    with pytest.raises(KeyboardInterrupt):
        homed.arm.move(POSE)
    homed.clock.sleep(5.0)
    stopped = homed.true_deg()
    homed.clock.sleep(60.0)
    assert homed.true_deg() == stopped
    assert stopped["light_phi"] < 250.0
    assert homed.twin.bus.read(4, 0x000E, 1) == [0x7500]
    homed.bus.plan = {}
    homed.arm.enable()
    homed.arm.home()
    homed.arm.move(POSE)


@pytest.mark.parametrize(("name", "angle"), [("view_theta", 91.5), ("light_phi", -6.0)])
def test_beyond_the_travel_nothing_is_sent(homed, name, angle):
    with pytest.raises(BadInputError, match=name):
        homed.arm.move(POSE | {name: angle})
    assert homed.bus.written == []


def test_an_axis_that_is_not_there(homed):
    with pytest.raises(BadInputError, match="no axis 'roll'"):
        homed.arm.move({"roll": 3.0})


def test_nothing_moves_before_homing(bench):
    bench.arm.enable()
    before = bench.true_deg()
    with pytest.raises(DeviceFaultError, match="view_theta: is not homed"):
        bench.arm.move(POSE)
    bench.clock.sleep(10.0)
    assert bench.true_deg() == before


@pytest.mark.parametrize("approach_deg", [2.0, -2.0])
def test_one_sided_approach(make_bench, rig_with, approach_deg):
    bench = make_bench(rig_with("axis.view_phi", approach_deg=approach_deg)).homed()
    axis = bench.rig.axis.view_phi
    sides = []
    for angle in (100.0, 50.0, 51.0, 200.0):
        bench.bus.written.clear()
        bench.arm.move({"view_phi": angle, "light_phi": angle})
        assert bench.arm.angles_deg()["view_phi"] == pytest.approx(angle)
        ways = [axis.to_degrees(high << 16 | low) for high, low in bench.bus.targets(2)]
        sides.append(ways)
        assert len(bench.bus.targets(4)) == 1, "axes with no run-up go there at once"
    direct = [len(ways) == 1 for ways in sides]
    up = approach_deg > 0
    assert direct == [up, not up, False, up]
    assert sides[2] == pytest.approx([51.0 - approach_deg, 51.0])


def test_a_run_up_stays_within_the_travel(make_bench, rig_with):
    bench = make_bench(rig_with("axis.view_theta", approach_deg=2.0)).homed()
    bench.arm.move({"view_theta": 30.0})
    bench.arm.move({"view_theta": 0.0})
    assert bench.arm.angles_deg()["view_theta"] == pytest.approx(0.0)


def test_stop_ends_a_move_disabled(homed):
    homed.twin.bus.write(1, 0x0004, [1, 0])
    homed.twin.bus.write(1, 0x0000, [0x1F])
    homed.clock.sleep(1.0)
    homed.arm.stop()
    assert homed.states() == [DISABLED] * 4
    angles = homed.arm.angles_deg()
    homed.clock.sleep(1.0)
    assert homed.arm.angles_deg() == angles
    homed.arm.enable()
    homed.arm.move(POSE)


def test_release_disables_all(homed):
    homed.arm.release()
    assert homed.states() == [DISABLED] * 4


def test_angles_come_from_the_encoder(homed):
    homed.twin.drives["view_theta"].axis.jammed_at = 20000.4
    angle = homed.arm.angles_deg()["view_theta"]
    assert angle == (20000 - 6000) / 2000.0
    assert not math.isclose(angle, homed.true_deg()["view_theta"], abs_tol=1e-9)


class _Always(dict):
    def __init__(self, what):
        self.what = what

    def get(self, _number, _default=None):
        return self.what


def test_a_wait_for_others_does_not_wait_for_drives_that_are_gone(homed):
    def gone(_):
        raise TransportLostError("bus: is gone; plug it in again")

    files = LocalFolder(homed.folder)
    instrument = Instrument.of(homed.bus, homed.line, files, homed.rig, homed.clock)
    # what never was there is not waited for
    instrument.arm.enable()
    homed.bus.plan = _Always(gone)
    began = homed.clock.now()
    instrument.clock.sleep(60.0)
    assert homed.clock.now() - began < 61.0
