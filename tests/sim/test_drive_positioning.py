"""Profile position: the set-point handshake, the buffer, refusals, halt, quick stop, settling."""

import pytest

NO, YES = 0, 1
TRAVEL_COUNTS = (4000, 188000)


def test_a_set_point_is_acknowledged_and_reached(homed):
    homed.target(60000)
    assert homed.bits(12) == (NO,)
    homed.control(0x1F)
    assert homed.bits(10, 11, 12, 13) == (0, 0, 1, 0)
    homed.control(0x0F)
    assert homed.bits(10, 12) == (0, 0)
    homed.clock.sleep(2.4)
    assert homed.bits(10) == (NO,)
    # 30 deg at 20 deg/s and 20 deg/s2 take 2.5 s
    homed.clock.sleep(0.1)
    assert homed.bits(10) == (YES,)
    assert homed.read_int32(0x0006) == 60000
    assert homed.read_int32(0x000C) == 0


def test_the_acknowledge_waits_for_bit_4_to_fall(homed):
    assert homed.go(60000)
    homed.clock.sleep(10.0)
    assert homed.bits(10, 12) == (1, 1)
    homed.control(0x0F)
    assert homed.bits(10, 12) == (1, 0)


def test_bit_4_held_takes_no_second_set_point(homed):
    homed.go(60000)
    homed.target(80000)
    homed.control(0x1F)
    homed.clock.sleep(10.0)
    assert homed.read_int32(0x0006) == 60000


def test_one_set_point_is_buffered(homed):
    assert homed.go(60000)
    assert homed.go(80000)
    homed.control(0x0F)
    assert homed.bits(12) == (1,), "the buffer is not free"
    homed.clock.sleep(2.6)
    # the first is reached, the second under way
    assert homed.bits(10, 12) == (0, 0)
    homed.clock.sleep(10.0)
    assert homed.bits(10) == (1,)
    assert homed.read_int32(0x0006) == 80000


def test_a_third_set_point_finds_no_room(homed):
    homed.go(60000)
    homed.go(80000)
    assert not homed.go(100000)
    homed.clock.sleep(20.0)
    assert homed.read_int32(0x0006) == 80000


def test_change_immediately_gives_up_the_others(homed):
    homed.go(180000)
    homed.go(170000)
    homed.clock.sleep(2.0)
    assert homed.go(10000, control=0x3F)
    homed.clock.sleep(30.0)
    assert homed.bits(10) == (1,)
    assert homed.read_int32(0x0006) == 10000


def test_a_set_point_carries_the_velocity_it_was_given_with(homed):
    homed.go(20000)
    homed.write(0x0008, 0, 2000)
    homed.go(22000)
    homed.write(0x0008, 0, 40000)
    homed.clock.sleep(1.5)
    start = homed.read_int32(0x0006)
    homed.clock.sleep(0.1)
    assert homed.read_int32(0x0006) - start == pytest.approx(204, abs=5)


def test_velocity_0_does_not_move(homed):
    homed.write(0x0008, 0, 0)
    assert homed.go(60000)
    homed.clock.sleep(100.0)
    assert homed.bits(10) == (0,)
    assert homed.read_int32(0x0006) == 0


REFUSED = [
    ("one count below the travel", 3999),
    ("one count above the travel", 188001),
    ("far below", -(2**31)),
    ("far above", 2**31 - 1),
]


@pytest.mark.parametrize(("name", "counts"), REFUSED)
def test_a_set_point_beyond_the_travel_is_refused(homed, name, counts):
    assert homed.go(60000)
    homed.clock.sleep(10.0)
    assert not homed.go(counts)
    assert homed.bits(11, 12) == (1, 0)
    homed.clock.sleep(5.0)
    assert homed.bits(10, 11) == (1, 1)
    assert homed.read_int32(0x0006) == 60000
    homed.control(0x0F)
    assert homed.bits(11) == (1,), "it stays until the next accepted one"
    assert homed.go(70000)
    assert homed.bits(11) == (0,)


@pytest.mark.parametrize("counts", TRAVEL_COUNTS)
def test_the_ends_of_the_travel_belong_to_it(homed, counts):
    assert homed.go(counts)
    homed.clock.sleep(15.0)
    assert homed.read_int32(0x0006) == counts


def test_a_refusal_leaves_the_move_under_way_alone(homed):
    homed.go(60000)
    assert not homed.go(0)
    homed.clock.sleep(10.0)
    assert homed.read_int32(0x0006) == 60000


def test_bit_12_decides_even_when_the_buffer_is_full(homed):
    homed.go(60000)
    homed.go(80000)
    assert not homed.go(0, control=0x3F)
    assert homed.bits(11, 12) == (1, 0)


def test_nothing_moves_before_homing(unit):
    unit.write(0x0002, 1)
    unit.enable()
    assert not unit.go(60000)
    assert unit.bits(11, 12) == (1, 0)
    unit.clock.sleep(5.0)
    assert unit.read_int32(0x0006) == 0


def test_nothing_moves_without_a_mode(unit):
    unit.enable()
    assert not unit.go(60000)
    unit.clock.sleep(5.0)
    assert unit.read_int32(0x0006) == 0


def test_nothing_moves_unless_enabled(homed):
    homed.control(0x07)
    homed.target(60000)
    homed.control(0x17)
    homed.clock.sleep(5.0)
    assert homed.read_int32(0x0006) == 0


def test_halt_stops_and_resumes_both_set_points(homed):
    homed.go(60000)
    homed.go(80000)
    homed.clock.sleep(1.0)
    homed.control(0x10F)
    assert homed.bits(10) == (0,)
    homed.clock.sleep(1.1)
    assert homed.bits(10) == (1,), "under halt it means standstill"
    stopped = homed.read_int32(0x0006)
    homed.clock.sleep(5.0)
    assert homed.read_int32(0x0006) == stopped < 60000
    homed.control(0x0F)
    assert homed.bits(10) == (0,)
    homed.clock.sleep(10.0)
    assert homed.bits(10) == (1,)
    assert homed.read_int32(0x0006) == 80000


def test_a_set_point_under_halt_waits(homed):
    homed.control(0x10F)
    homed.target(60000)
    homed.control(0x11F)
    assert homed.bits(12) == (1,)
    homed.clock.sleep(5.0)
    assert homed.read_int32(0x0006) == 0
    homed.control(0x0F)
    homed.clock.sleep(5.0)
    assert homed.read_int32(0x0006) == 60000


def test_quick_stop_gives_up_the_set_points(homed):
    homed.go(60000)
    homed.go(80000)
    homed.clock.sleep(1.0)
    homed.control(0x02)
    homed.clock.sleep(2.0)
    stopped = homed.read_int32(0x0006)
    homed.enable()
    homed.clock.sleep(5.0)
    assert homed.bits(10, 12) == (1, 0)
    assert homed.read_int32(0x0006) == stopped


def test_the_mode_changes_at_standstill(homed):
    homed.go(60000)
    homed.write(0x0002, 6)
    assert homed.read(0x0002) == 6
    assert homed.read(0x0003) == 1
    homed.clock.sleep(5.0)
    assert homed.read(0x0003) == 6


def test_the_settle_register_rings_down_in_about_a_second(homed):
    homed.go(60000)
    for axis in (1, 2):
        assert homed.bus.read(axis, 0x0011, 1) == [65535]
    for axis in (3, 4):
        assert homed.bus.read(axis, 0x0011, 1)[0] < 65535
    while not homed.status & 0x0400:
        homed.clock.sleep(0.001)
    stopped = homed.clock.now()
    # the peak over the last half second cannot fall before it has passed
    assert homed.read(0x0011) == pytest.approx(200, abs=1)
    homed.clock.sleep(0.45)
    assert homed.read(0x0011) == pytest.approx(200, abs=1)
    while homed.read(0x0011) > 12:
        homed.clock.sleep(0.01)
    assert 0.9 < homed.clock.now() - stopped < 1.1
    assert homed.bus.read(2, 0x0011, 1) == homed.bus.read(1, 0x0011, 1)
    homed.clock.sleep(2.0)
    assert homed.read(0x0011) == 0


def test_a_gentler_stop_shakes_less(homed):
    homed.write(0x000A, 0, 4000)
    homed.go(10000)
    homed.clock.sleep(3.2)
    assert homed.bits(10) == (1,)
    assert homed.read(0x0011) == pytest.approx(20, abs=1)


def test_no_way_to_go_shakes_nothing(homed):
    homed.go(60000)
    homed.clock.sleep(20.0)
    assert homed.go(60000)
    assert homed.bits(10) == (1,)
    assert homed.read(0x0011) == 0
