import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.rig import default_rig
from gonio.timemodel import move_time
from sim.motion import go, rest, stop

POSITION = st.floats(-1e5, 1e5)
TARGET = st.integers(-(10**5), 10**5)
SPEED = st.floats(1.0, 1e5)
ACCELERATION = st.floats(10.0, 1e6)
START = st.floats(0.0, 1e4)
SHARES = [i / 40 for i in range(41)]


def times(motion, start):
    return [start + share * (motion.end_s - start) for share in SHARES]


@given(START, POSITION, TARGET, SPEED, ACCELERATION)
def test_a_move_from_rest_keeps_its_limits_and_ends_at_the_target(start, x, target, speed, accel):
    motion = go(start, x, 0.0, target, speed, accel)
    states = [motion.at(t) for t in times(motion, start)]
    assert motion.at(motion.end_s) == (target, 0.0)
    assert all(abs(v) <= speed * (1 + 1e-9) for _, v in states)
    assert all(min(x, target) - 1e-6 <= p <= max(x, target) + 1e-6 for p, _ in states)
    assert all(abs(piece.acceleration) in (0.0, accel) for piece in motion.pieces)


@given(START, POSITION, st.floats(-1e5, 1e5), TARGET, SPEED, ACCELERATION)
def test_a_move_from_a_running_start_is_continuous(start, x, v, target, speed, accel):
    motion = go(start, x, v, target, speed, accel)
    slack = 1e-9 * (1e5 + v * v / accel + 1e4 * max(abs(v), speed))
    assert motion.at(start) == pytest.approx((x, v), abs=slack)
    assert motion.at(motion.end_s) == (target, 0.0)
    just_before = max(start, math.nextafter(motion.end_s, -math.inf))
    # positions are sums of a few terms as large as the way, times of a clock at 1e4 s
    assert motion.at(just_before)[0] == pytest.approx(target, abs=10 * slack)
    assert all(abs(piece.acceleration) in (0.0, accel) for piece in motion.pieces)
    fastest = max(speed, abs(v)) * (1 + 1e-9) + accel * 1e-9 * 1e4
    assert all(abs(motion.at(t)[1]) <= fastest for t in times(motion, start))


@given(START, POSITION, st.floats(-1e5, 1e5), ACCELERATION)
def test_a_stop_takes_the_shortest_way(start, x, v, accel):
    motion = stop(start, x, v, accel)
    assert motion.end_s - start == pytest.approx(abs(v) / accel, abs=1e-9)
    assert motion.end == pytest.approx(x + v * abs(v) / (2 * accel))


@given(st.floats(0.001, 360.0))
def test_moves_take_what_the_time_model_says(distance_deg):
    axis = default_rig().axis.view_phi
    motion = go(0.0, 0.0, 0.0, distance_deg, axis.max_velocity_deg_s, axis.max_acceleration_deg_s2)
    assert motion.end_s == pytest.approx(float(move_time(distance_deg, axis)))


def test_moving_away_from_the_target_stops_first():
    motion = go(0.0, 0.0, -10.0, 20.0, 10.0, 10.0)
    assert motion.at(1.0) == pytest.approx((-5.0, 0.0))
    assert motion.end_s == pytest.approx(1.0 + 1.0 + 1.5 + 1.0)


def test_a_lower_speed_is_reached_by_braking():
    motion = go(0.0, 0.0, 20.0, 100.0, 10.0, 10.0)
    assert motion.at(1.0) == pytest.approx((15.0, 10.0))
    assert motion.end_s == pytest.approx(1.0 + 8.0 + 1.0)


def test_a_running_start_shortens_the_way():
    motion = go(0.0, 0.0, 10.0, 20.0, 100.0, 10.0)
    peak = math.sqrt(10.0 * 20.0 + 10.0**2 / 2)
    assert motion.end_s == pytest.approx((peak - 10.0) / 10.0 + peak / 10.0)


def test_without_speed_a_move_never_ends():
    motion = go(0.0, 5.0, 0.0, 100.0, 0.0, 10.0)
    assert motion.end_s == math.inf
    assert motion.at(1e6) == (5.0, 0.0)


def test_rest_is_over_before_it_began():
    assert rest(3.5).at(-1e9) == (3.5, 0.0)
