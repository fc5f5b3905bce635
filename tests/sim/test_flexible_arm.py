"""An arm that swings after a move: its closed form, the equation it solves, the settle register."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from sim.dynamics.integrate import Integration, at_rest
from sim.dynamics.parameters import AxisParameters
from sim.dynamics.state import LOAD
from sim.dynamics.stepper import Stepper
from sim.dynamics.travel import travel
from sim.flexible_arm import FlexibleArm
from sim.motion import go
from sim.vibration import MOVING

PER_DEG = 2000.0
HZ = st.floats(2.0, 10.0)
DAMPING = st.floats(0.005, 0.3)


def solved(motion, hz, damping, times):
    """The same swing by a solver, a piece of constant acceleration at a time."""
    rate, state, seen = 2 * math.pi * hz, [0.0, 0.0], []
    ends = [*(piece.start_s for piece in motion.pieces), motion.end_s - motion.start_s]
    spans = zip(pairwise(ends), motion.pieces, strict=True)
    pieces = [(begin, end, piece.acceleration) for (begin, end), piece in spans]
    pieces.append((ends[-1], ends[-1] + times[-1], 0.0))
    for begin, end, acceleration in pieces:
        pull = math.radians(acceleration / PER_DEG)
        solution = solve_ivp(
            lambda _, q, pull=pull: [q[1], -pull - 2 * damping * rate * q[1] - rate**2 * q[0]],
            (begin, end), state, rtol=1e-9, atol=1e-14, dense_output=True,
        )  # fmt: skip
        state, seen = solution.y[:, -1], solution.sol(ends[-1] + times)[0]
    return seen


@settings(max_examples=20)
@given(HZ, DAMPING, st.floats(-40.0, 40.0).filter(lambda way: abs(way) > 0.1))
def test_a_swing_is_what_its_equation_says(hz, damping, way_deg):
    motion = go(3.0, 0.0, 0.0, way_deg * PER_DEG, 20 * PER_DEG, 20 * PER_DEG)
    arm = FlexibleArm(hz, damping)
    arm.kick("view_theta", motion, PER_DEG)
    times = np.linspace(0.0, 1.0, 40)
    ours = arm.deflection_rad("view_theta", motion.end_s + times)
    assert ours == pytest.approx(solved(motion, hz, damping, times), abs=1e-9)


@given(HZ, DAMPING, st.lists(st.floats(0.0, 5.0), min_size=1, max_size=5))
def test_the_register_falls_and_bounds_the_swing(hz, damping, waits):
    arm = FlexibleArm(hz, damping)
    motion = go(0.0, 0.0, 0.0, 30 * PER_DEG, 20 * PER_DEG, 20 * PER_DEG)
    arm.kick("view_theta", motion, PER_DEG)
    now, before = motion.end_s, MOVING
    for wait in waits:
        now += wait
        said = arm.settle_urad(now)
        assert abs(arm.deflection_rad("view_theta", np.array([now]))[0]) <= 1e-6 * (said + 1)
        assert said <= before
        before = said


def test_a_move_of_whole_periods_leaves_least():
    # a ramp of one period ends its own swing: what input shapers live by
    def left(ramp_s):
        arm = FlexibleArm(5.0, 0.005)
        motion = go(0.0, 0.0, 0.0, 20.0 * ramp_s * PER_DEG, 20.0 * PER_DEG, 20.0 / ramp_s * PER_DEG)
        arm.kick("view_theta", motion, PER_DEG)
        return arm.settle_urad(motion.end_s)

    assert left(0.2) < 0.1 * left(0.3)


def test_both_axes_of_an_arm_shake_it():
    motion = go(0.0, 0.0, 0.0, 1000.0, 40000.0, 40000.0)
    one, both = FlexibleArm(5.0, 0.02), FlexibleArm(5.0, 0.02)
    one.kick("view_theta", motion, PER_DEG)
    for axis in ("view_theta", "view_phi"):
        both.kick(axis, motion, PER_DEG)
    said = [arm.settle_urad(motion.end_s) for arm in (one, both)]
    assert said[1] == pytest.approx(math.sqrt(2.0) * said[0], abs=1)


def test_the_whole_axis_swings_so_where_its_servo_is_stiff():
    axis = replace(AxisParameters(), play_rad=0.0, gravity_nm=0.0, bearing=0.0,
                   position_gain=1e5, velocity_gain=1300.0)  # fmt: skip
    run = Integration(Stepper(axis), at_rest(0.5), 1e-6)
    travel(run, 0.9, 0.35, 0.31)
    seen = []
    for _ in range(128):
        run.advance(1 / 128)
        seen.append(run.state[LOAD])
    damping = axis.damping / 2 / math.sqrt(axis.stiffness * axis.load_inertia)
    arm, motion = FlexibleArm(axis.resonance_hz, damping), go(0.0, 0.5, 0.0, 0.9, 0.35, 0.31)
    # positions are in rad here
    arm.kick("view_theta", motion, math.radians(1.0))
    closed = arm.deflection_rad("view_theta", motion.end_s + np.arange(1, 129) / 128)
    swing = np.array(seen) - np.mean(seen)
    assert np.corrcoef(swing, closed)[0, 1] > 0.98
    assert swing.std() == pytest.approx(closed.std(), rel=0.05)
