"""The state machine of CiA 402: states under the masks, commands, faults, interlock, watchdog."""

import pytest

DISABLED, READY, SWITCHED_ON, ENABLED = 0x40, 0x21, 0x23, 0x27
QUICK_STOP, REACTION, FAULT, NOT_READY = 0x07, 0x0F, 0x08, 0x00

REACH = {
    DISABLED: [],
    READY: [0x06],
    SWITCHED_ON: [0x06, 0x07],
    ENABLED: [0x06, 0x07, 0x0F],
}

TRANSITIONS = [
    (DISABLED, 0x06, READY),
    (DISABLED, 0x07, DISABLED),
    (DISABLED, 0x0F, DISABLED),
    (DISABLED, 0x02, DISABLED),
    (DISABLED, 0x00, DISABLED),
    (DISABLED, 0x80, DISABLED),
    (READY, 0x06, READY),
    (READY, 0x07, SWITCHED_ON),
    (READY, 0x0F, ENABLED),
    (READY, 0x02, DISABLED),
    (READY, 0x00, DISABLED),
    (SWITCHED_ON, 0x06, READY),
    (SWITCHED_ON, 0x07, SWITCHED_ON),
    (SWITCHED_ON, 0x0F, ENABLED),
    (SWITCHED_ON, 0x02, DISABLED),
    (SWITCHED_ON, 0x0D, DISABLED),
    (ENABLED, 0x06, READY),
    (ENABLED, 0x0E, READY),
    (ENABLED, 0x07, SWITCHED_ON),
    (ENABLED, 0x0F, ENABLED),
    (ENABLED, 0x0B, DISABLED),  # quick stop, and there is nothing to stop
    (ENABLED, 0x00, DISABLED),
]


@pytest.mark.parametrize(("state", "controlword", "after"), TRANSITIONS)
def test_each_command_in_each_state(unit, state, controlword, after):
    unit.control(*REACH[state])
    assert unit.state == state
    unit.control(controlword)
    assert unit.state == after


def test_bits_that_drivers_must_mask_are_set(unit):
    assert unit.status & 0x0210 == 0x0210


def test_power_up_takes_a_while_and_forgets(homed):
    homed.write(0x0010, 500)
    homed.drive.power_up(homed.clock.now())
    assert homed.state == NOT_READY
    homed.control(0x06)
    assert homed.state == NOT_READY
    homed.clock.sleep(0.5)
    assert homed.state == DISABLED
    assert homed.read_int32(0x0006) == 0
    assert homed.read(0x0010) == 0
    homed.enable()
    homed.write(0x0002, 6)
    assert homed.bits(10, 12, 13) == (1, 0, 0)


def test_quick_stop_ramps_down_and_ends_disabled(homed):
    homed.go(100000)
    homed.clock.sleep(2.0)
    homed.control(0x02)
    assert homed.state == QUICK_STOP
    homed.control(0x0F)
    assert homed.state == QUICK_STOP
    position = homed.read_int32(0x0006)
    homed.clock.sleep(1.0)
    assert homed.state == DISABLED
    # 20 deg/s on a ramp of 20 deg/s2: 10 deg, less what passed since the command
    assert 19000 < homed.read_int32(0x0006) - position < 20000
    homed.enable()
    homed.clock.sleep(5.0)
    assert homed.read(0x0011) == 0


@pytest.mark.parametrize("controlword", [0x06, 0x07, 0x00])
def test_leaving_operation_stops_the_axis(homed, controlword):
    homed.go(100000)
    homed.clock.sleep(2.0)
    homed.control(controlword)
    homed.clock.sleep(1.0)
    position = homed.read_int32(0x0006)
    homed.clock.sleep(1.0)
    assert homed.read_int32(0x0006) == position < 90000


@pytest.mark.parametrize("code", [0x2310, 0x4310])
def test_a_fault_waits_for_a_rising_edge(homed, code):
    homed.go(100000)
    homed.clock.sleep(2.0)
    homed.drive.control.trip(code, homed.clock.now())
    assert homed.state == REACTION
    assert homed.read(0x000E) == code
    homed.control(0x80, 0x00)
    homed.clock.sleep(1.1)
    assert homed.state == FAULT
    homed.control(0x06, 0x0F)
    assert homed.state == FAULT
    homed.control(0x80)
    assert homed.state == DISABLED
    assert homed.read(0x000E) == 0
    homed.drive.control.trip(code, homed.clock.now())
    homed.control(0x80)
    assert homed.state == FAULT, "bit 7 was never low"
    homed.control(0x00, 0x80)
    assert homed.state == DISABLED
    homed.enable()
    assert homed.go(90000), "homing survives a fault"


def test_following_error(homed):
    homed.drive.axis.jammed_at = homed.drive.axis.actual(homed.clock.now())
    homed.go(100000)
    homed.clock.sleep(0.3)
    assert homed.state == ENABLED
    assert homed.read_int32(0x000C) == pytest.approx(40000 * 0.3**2 / 2, rel=0.1)
    homed.clock.sleep(0.3)
    assert homed.state in (REACTION, FAULT)
    assert homed.read(0x000E) == 0x8611
    assert homed.bits(13) == (1,)
    homed.control(0x00, 0x80)
    assert homed.bits(13) == (0,)
    assert homed.read(0x000E) == 0


def test_the_load_trails_the_demand_while_it_moves(homed):
    homed.go(100000)
    homed.clock.sleep(1.5)
    assert homed.read_int32(0x000C) == pytest.approx(80, abs=1)
    homed.clock.sleep(10.0)
    assert homed.read_int32(0x000C) == 0


def test_an_open_interlock_stops_and_holds(homed, twin):
    homed.go(100000)
    homed.clock.sleep(2.0)
    twin.set_interlock(True)
    assert homed.state == QUICK_STOP
    assert homed.read(0x000F) & 8
    homed.clock.sleep(1.1)
    assert homed.state == DISABLED
    homed.control(0x06, 0x07, 0x0F)
    assert homed.state == DISABLED
    assert homed.read(0x000E) == 0
    position = homed.read_int32(0x0006)
    twin.set_interlock(False)
    homed.clock.sleep(1.0)
    assert homed.state == DISABLED
    assert homed.read_int32(0x0006) == position
    homed.enable()
    homed.clock.sleep(1.0)
    assert homed.read_int32(0x0006) == position
    assert homed.go(100000), "homing is kept"


@pytest.mark.parametrize("steps", [[0x06], [0x06, 0x07]])
def test_an_open_interlock_disables_what_is_not_in_operation(unit, twin, steps):
    unit.control(*steps)
    twin.set_interlock(True)
    assert unit.state == DISABLED


def test_an_open_interlock_hides_no_fault(homed, twin):
    homed.drive.control.trip(0x2310, homed.clock.now())
    twin.set_interlock(True)
    assert homed.state == FAULT
    homed.control(0x00, 0x80, 0x00, 0x06)
    assert homed.state == DISABLED


def test_the_watchdog_bites_in_operation_only(homed):
    homed.control(0x07)
    homed.write(0x0010, 100)
    homed.clock.sleep(5.0)
    assert homed.state == SWITCHED_ON
    homed.control(0x0F)
    homed.clock.sleep(0.09)
    assert homed.state == ENABLED
    homed.clock.sleep(0.101)
    assert homed.state == FAULT
    assert homed.read(0x000E) == 0x7500
    homed.control(0x00, 0x80)
    assert homed.read(0x0010) == 100, "it survives a fault reset"


def test_the_watchdog_stops_a_move_on_a_ramp(homed):
    homed.write(0x0010, 500)
    homed.go(180000)
    homed.clock.sleep(0.8)
    assert homed.state == REACTION
    homed.clock.sleep(1.0)
    assert homed.state == FAULT
    # half a second of acceleration, up to 10 deg/s, and the same to stop
    assert homed.read_int32(0x0006) == pytest.approx(10000, abs=500)


def test_only_requests_answered_well_feed_the_watchdog(homed):
    homed.write(0x0010, 100)
    for _ in range(10):
        homed.clock.sleep(0.05)
        homed.read(0x0001)
    assert homed.state == ENABLED
    for _ in range(10):
        homed.clock.sleep(0.05)
        assert homed.refusal(homed.read, 0x0012) == 2
        homed.bus.read(2, 0x0001, 1)
    assert homed.state == FAULT
