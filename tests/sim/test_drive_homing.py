"""Homing mode: bits 10, 12 and 13, the switches, and what homing survives."""

import pytest

RUNNING, IDLE, ATTAINED = (0, 0, 0), (1, 0, 0), (1, 1, 0)


@pytest.fixture
def ready(unit):
    """Enabled in homing mode."""
    unit.enable()
    unit.write(0x0002, 6)
    assert unit.read(0x0003) == 6
    return unit


def test_the_position_starts_anywhere_and_ends_at_the_edge(ready):
    assert ready.bits(10, 12, 13) == IDLE
    assert ready.read_int32(0x0006) == 0
    assert not ready.read(0x000F) & 4
    ready.control(0x1F)
    assert ready.bits(10, 12, 13) == RUNNING
    ready.clock.sleep(1.0)
    assert ready.read_int32(0x0006) < 0
    ready.clock.sleep(29.0)
    assert ready.bits(10, 12, 13) == ATTAINED
    assert ready.read_int32(0x0006) == 0
    assert ready.read(0x000F) & 4
    # the edge is at count 0, which is -3 deg
    assert ready.drive.axis.actual_deg(ready.clock.now()) == -3.0


@pytest.mark.parametrize("axis", [1, 2, 3, 4])
def test_every_axis_homes_within_half_a_minute(units, clock, axis):
    one = units[axis]
    one.enable()
    one.write(0x0002, 6)
    one.control(0x1F)
    clock.sleep(30.0)
    assert one.bits(10, 12, 13) == ATTAINED


def test_clearing_bit_4_interrupts(ready):
    ready.control(0x1F)
    ready.clock.sleep(1.0)
    ready.control(0x0F)
    assert ready.bits(10, 12, 13) == IDLE
    ready.clock.sleep(30.0)
    assert ready.bits(10, 12, 13) == IDLE
    ready.write(0x0002, 1)
    assert not ready.go(60000)


def test_halt_interrupts(ready):
    ready.control(0x1F)
    ready.clock.sleep(1.0)
    ready.control(0x11F)
    ready.clock.sleep(30.0)
    assert ready.bits(10, 12, 13) == IDLE


def test_a_new_homing_loses_the_position(homed):
    homed.write(0x0002, 6)
    assert homed.bits(10, 12, 13) == ATTAINED
    homed.control(0x1F)
    assert homed.bits(12) == (0,)
    homed.control(0x0F)
    homed.write(0x0002, 1)
    homed.clock.sleep(5.0)
    assert not homed.go(60000)


def test_attained_survives_stops_modes_and_faults(homed):
    homed.control(0x02)
    homed.enable()
    homed.drive.control.trip(0x2310, homed.clock.now())
    homed.control(0x00, 0x80)
    homed.enable()
    homed.write(0x0002, 6)
    assert homed.bits(10, 12, 13) == ATTAINED
    homed.write(0x0002, 1)
    assert homed.go(60000)


def test_attained_is_read_in_mode_6_whatever_the_state(homed):
    homed.control(0x00)
    homed.write(0x0002, 6)
    assert homed.bits(10, 12, 13) == ATTAINED


@pytest.mark.parametrize(("axis", "limit"), [(1, 1), (3, 2)])
def test_a_broken_switch_ends_at_the_limit(units, clock, axis, limit):
    one = units[axis]
    one.drive.homing.switch_works = False
    one.enable()
    one.write(0x0002, 6)
    one.control(0x1F)
    clock.sleep(30.0)
    assert one.bits(12, 13) == (0, 1)
    assert one.bits(11) == (1,)
    assert one.read(0x000F) & 3 == limit
    one.drive.homing.switch_works = True
    one.control(0x0F, 0x1F)
    clock.sleep(30.0)
    assert one.bits(10, 12, 13) == ATTAINED
    assert one.bits(11) == (0,)


def test_an_interlock_interrupts_homing(ready, twin):
    ready.control(0x1F)
    ready.clock.sleep(1.0)
    twin.set_interlock(True)
    twin.set_interlock(False)
    ready.clock.sleep(2.0)
    assert ready.bits(10, 12, 13) == IDLE


def test_homing_again_finds_the_same_edge(homed):
    homed.go(60000)
    homed.clock.sleep(5.0)
    homed.control(0x0F)
    homed.home()
    assert homed.read_int32(0x0006) == 0
    assert homed.drive.axis.actual(homed.clock.now()) == 0.0
