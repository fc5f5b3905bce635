"""What the arm's driver makes of drives that fail and of a bus that loses things."""

import pytest

from gonio.errors import DeviceFaultError, RegisterError, TransportTimeoutError

POSE = {"view_theta": 45.0, "view_phi": 120.0, "light_theta": 15.0, "light_phi": 300.0}
DISABLED = 0x40


def trip(axis, code):
    return lambda bench: bench.twin.drives[axis].control.trip(code, bench.clock.now())


def jam(bench):
    axis = bench.twin.drives["light_phi"].axis
    axis.jammed_at = axis.actual(bench.clock.now())


FAULTS = [
    ("over-current", trip("view_phi", 0x2310), r"view_phi: .*0x2310, over-current.* deg; .*blocks"),
    ("over-temperature", trip("light_phi", 0x4310), r"light_phi: .*over-temperature.* cool down"),
    ("watchdog", trip("view_phi", 0x7500), r"view_phi: .*communication lost.* deg; .*cable"),
    ("unknown code", trip("view_phi", 0x5530), r"view_phi: .*0x5530.*manual"),
    ("something blocks the arm", jam, r"light_phi: .*0x8611, following error.* at .* deg"),
    (
        "interlock",
        lambda bench: bench.twin.set_interlock(True),
        r"interlock open.* at .* deg; close the door",
    ),
    (
        "somebody else disables the drive",
        lambda bench: bench.twin.bus.write(2, 0, [0]),
        r"view_phi: .*'switch on disabled'.*nothing else drives",
    ),
]


@pytest.mark.parametrize(("name", "fault", "message"), FAULTS, ids=[name for name, *_ in FAULTS])
def test_a_fault_on_the_way_stops_everything(homed, name, fault, message):
    homed.at(3.0, lambda: fault(homed))
    with pytest.raises(DeviceFaultError, match=message) as caught:
        homed.arm.move(POSE)
    assert "\n" not in str(caught.value)
    assert caught.value.exit_code == 3
    assert all(state in (DISABLED, 0x08, 0x28, 0x60) for state in homed.states())
    stopped = homed.true_deg()
    homed.clock.sleep(10.0)
    assert homed.true_deg() == stopped


def test_a_drive_recovers_from_a_fault(homed):
    homed.at(1.0, lambda: trip("view_phi", 0x2310)(homed))
    with pytest.raises(DeviceFaultError):
        homed.arm.move(POSE)
    homed.arm.enable()
    homed.arm.home()
    homed.arm.move(POSE)
    assert homed.arm.angles_deg() == pytest.approx(POSE)


def test_an_open_interlock_is_said_when_enabling(bench):
    bench.twin.set_interlock(True)
    with pytest.raises(DeviceFaultError, match=r"view_theta: .*interlock open"):
        bench.arm.enable()


def test_a_drive_that_stays_in_fault(bench):
    drive = bench.twin.drives["light_theta"]
    bench.bus.answers = {0x0001: lambda unit, words: [0x0208] if unit == 3 else words}
    drive.control.trip(0x4310, bench.clock.now())
    bench.bus.answers[0x000E] = lambda unit, words: [0x4310]
    with pytest.raises(DeviceFaultError, match=r"light_theta: stays in 'fault' .*over-temperature"):
        bench.arm.enable()


def test_the_drive_refuses_what_the_rig_file_allows(make_bench, rig_with):
    bench = make_bench(None, rig_with("axis.view_theta", max_deg=80.0)).homed()
    with pytest.raises(DeviceFaultError, match=r"view_theta: the drive refused 85.000 deg"):
        bench.arm.move({"view_theta": 85.0})
    bench.arm.enable()
    bench.arm.move({"view_theta": 79.0})


def test_bit_12_alone_says_that_a_set_point_is_refused(make_bench, rig_with):
    bench = make_bench(None, rig_with("axis.view_theta", max_deg=80.0)).homed()
    bench.bus.answers = {0x0001: lambda unit, words: [words[0] & ~0x0800]}
    with pytest.raises(DeviceFaultError, match=r"view_theta: the drive refused"):
        bench.arm.move({"view_theta": 85.0})


def test_an_old_refusal_does_not_spoil_the_next_move(homed):
    homed.twin.bus.write(1, 0x0004, [0, 0])
    homed.twin.bus.write(1, 0x0000, [0x1F])
    homed.twin.bus.write(1, 0x0000, [0x0F])
    assert homed.twin.bus.read(1, 0x0001, 1)[0] & 0x0800
    homed.arm.move(POSE)


def test_a_drive_that_lost_its_position_refuses(homed):
    homed.twin.drives["light_phi"].homing.attained = False
    with pytest.raises(DeviceFaultError, match=r"light_phi: the drive refused"):
        homed.arm.move(POSE)


def test_a_drive_that_was_switched_off_is_noticed(homed):
    homed.at(2.0, lambda: homed.twin.drives["view_phi"].power_up(homed.clock.now()))
    with pytest.raises(DeviceFaultError, match=r"view_phi: is no longer enabled"):
        homed.arm.move(POSE)
    homed.arm.enable()
    homed.arm.home()
    homed.arm.move(POSE)
    assert homed.true_deg() == pytest.approx(POSE, abs=0.001)


def test_a_drive_slower_than_the_rig_file_says(make_bench, rig_with):
    bench = make_bench(None, rig_with("axis.light_phi", max_velocity_deg_s=10.0))
    with pytest.raises(
        DeviceFaultError, match=r"light_phi: .*profile_velocity 20000 instead of 60"
    ):
        bench.arm.enable()


def test_a_limit_switch_on_the_way(homed):
    homed.bus.answers = {
        0x0001: lambda unit, words: [words[0] | 0x0800] if unit == 1 else words,
        0x000F: lambda unit, words: [2] if unit == 1 else words,
    }
    with pytest.raises(DeviceFaultError, match=r"view_theta: .*positive limit switch"):
        homed.arm.move(POSE)


def test_target_reached_is_not_believed_without_the_encoder(homed):
    axis = homed.twin.drives["view_theta"].axis
    homed.at(2.5, lambda: setattr(axis, "jammed_at", axis.actual(homed.clock.now())))
    with pytest.raises(DeviceFaultError, match=r"view_theta: did not arrive within"):
        homed.arm.move({"view_theta": 30.0})


def test_an_arm_that_does_not_get_still(homed):
    homed.bus.answers = {0x0011: lambda unit, words: [50] if unit >= 3 else words}
    with pytest.raises(DeviceFaultError, match=r"light arm: still shakes by 50 urad after 15 s"):
        homed.arm.move(POSE)


def test_homing_that_fails(bench):
    bench.twin.drives["view_phi"].homing.switch_works = False
    bench.arm.enable()
    with pytest.raises(DeviceFaultError, match=r"view_phi: homing failed .*negative limit switch"):
        bench.arm.home()
    stopped = bench.true_deg()
    bench.clock.sleep(60.0)
    assert bench.true_deg() == stopped


def test_homing_that_takes_too_long(make_bench, rig_with):
    bench = make_bench(rig_with("arm", homing_timeout_s=1.0))
    bench.arm.enable()
    with pytest.raises(DeviceFaultError, match=r"is not home after 1 s"):
        bench.arm.home()
    stopped = bench.true_deg()
    bench.clock.sleep(60.0)
    assert bench.true_deg() == stopped


def test_an_interlock_that_opens_while_homing(bench):
    bench.arm.enable()
    bench.at(1.0, lambda: bench.twin.set_interlock(True))
    with pytest.raises(DeviceFaultError, match=r"interlock open"):
        bench.arm.home()


def test_a_drive_that_is_not_there(make_bench, rig_with):
    bench = make_bench(rig_with("axis.light_phi", unit=9), rig_with("axis.light_phi", unit=4))
    with pytest.raises(RegisterError, match=r"unit 9, .*exception 11; no drive answers there"):
        bench.arm.enable()


def test_a_profile_of_another_drive(homed):
    def refuse(_):
        raise RegisterError(1, 0x0004, 3)

    homed.bus.plan = {9: refuse}
    with pytest.raises(RegisterError, match=r"register 0x0004: the drive answered exception 3"):
        homed.arm.move({"view_theta": 10.0})


@pytest.mark.parametrize("way", ["reply", "request"])
def test_whatever_is_lost_once_is_made_good(make_bench, lose, way):
    for number in range(0, 110, 3):
        bench = make_bench()
        bench.bus.plan = {number: lose[way]}
        bench.arm.enable()
        bench.arm.home()
        bench.bus.plan[bench.bus.count + number // 3] = lose[way]
        bench.arm.move(POSE)
        assert bench.true_deg() == pytest.approx(POSE, abs=0.001)
        for unit in (1, 2, 3, 4):
            assert bench.twin.bus.read(unit, 0x0000, 1) == [0x0F]


def test_a_bus_that_stays_silent(homed, lose):
    homed.bus.plan = dict.fromkeys(range(60, 2000), lose["request"])
    with pytest.raises(TransportTimeoutError, match="no reply"):
        homed.arm.move(POSE)


def test_stop_tells_every_axis_within_a_second_even_when_one_is_silent(homed, lose, monkeypatch):
    told_s, write = {}, homed.bus.write

    def silent_unit_1(unit, address, values):
        if unit == 1:
            return lose["request"](None)
        told_s.setdefault(unit, homed.clock.now())
        return write(unit, address, values)

    monkeypatch.setattr(homed.bus, "write", silent_unit_1)
    began_s = homed.clock.now()
    with pytest.raises(TransportTimeoutError):
        homed.arm.stop()
    assert homed.states()[1:] == [DISABLED] * 3
    assert max(told_s.values()) - began_s < 1.0
