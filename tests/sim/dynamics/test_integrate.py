"""An axis over time: laws that hold for any motion, and scipy's solvers beside it."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.dynamics.equations import energy_j
from sim.dynamics.integrate import Integration, at_rest
from sim.dynamics.parameters import STICKY, AxisParameters
from sim.dynamics.reference import ReferenceIntegration
from sim.dynamics.state import DEMAND_SPEED, LOAD, LOAD_SPEED, LOST, MOTOR, MOTOR_SPEED
from sim.dynamics.stepper import Stepper
from sim.dynamics.travel import travel

UNDRIVEN = replace(AxisParameters(), position_gain=0.0, velocity_gain=0.0)
STEPPERS = {"undriven": Stepper(UNDRIVEN), "driven": Stepper(AxisParameters())}
SPEED = st.floats(-0.5, 0.5)
ANGLE = st.floats(0.0, 1.55)
TIME = st.floats(-6.0, 0.5).map(lambda power: 10.0**power)


@settings(max_examples=25)
@given(ANGLE, st.floats(-2e-3, 2e-3), SPEED, SPEED, st.lists(TIME, min_size=1, max_size=4))
def test_an_axis_that_nothing_drives_only_loses_energy(angle, twist, motor, load, times):
    state = at_rest(angle)
    state[MOTOR] += twist
    state[MOTOR_SPEED], state[LOAD_SPEED] = motor, load
    run = Integration(STEPPERS["undriven"], state, 1e-6)
    begin = before = energy_j(run.state, run.mode, UNDRIVEN)
    for seconds in times:
        run.advance(seconds)
        after = energy_j(run.state, run.mode, UNDRIVEN)
        assert after <= before + 1e-6
        assert after - begin + run.state[LOST] == pytest.approx(0.0, abs=1e-4)
        before = after


@settings(max_examples=10)
@given(ANGLE, st.lists(TIME, min_size=2, max_size=4))
def test_a_time_may_be_cut_anywhere(angle, times):
    whole, cut = (Integration(STEPPERS["driven"], at_rest(angle), 1e-7) for _ in range(2))
    whole.advance(sum(times), 0.1)
    for seconds in times:
        cut.advance(seconds, 0.1)
    assert cut.state[LOAD] == pytest.approx(whole.state[LOAD], abs=1e-9)
    assert cut.state[DEMAND_SPEED] == pytest.approx(whole.state[DEMAND_SPEED], abs=1e-12)


@pytest.mark.parametrize("method", ["Radau", "LSODA"])
@pytest.mark.parametrize(
    ("axis", "start", "target"),
    [
        (AxisParameters(), 0.5, 0.6),
        (replace(AxisParameters(), play_rad=0.0), 0.5, 0.4),
        (replace(AxisParameters(), low_rad=-1.6, play_rad=2e-3), -0.05, 0.05),
        (AxisParameters(), 1.55, 1.65),
    ],
    ids=["move", "no play", "over the vertical", "end stop"],
)
def test_scipy_comes_to_the_same(axis, start, target, method):
    run = Integration(Stepper(axis), at_rest(start), 1e-7)
    other = ReferenceIntegration(axis, at_rest(start), method, 1e-8)
    for each in (run, other):
        travel(each, target, 0.35, 0.7)
        each.advance(0.25)
    assert run.state[LOAD] == pytest.approx(other.state[LOAD], abs=1e-8)
    assert (run.mode, run.events) == (other.mode, other.events)


def test_what_friction_holds_does_not_creep():
    run = Integration(Stepper(AxisParameters()), at_rest(0.5), 1e-6)
    run.advance(1.0)
    assert not run.mode.slides
    stood = run.state[MOTOR]
    run.advance(1e6)
    assert (run.state[MOTOR], run.state[MOTOR_SPEED]) == (stood, 0.0)


def test_a_rest_is_a_few_steps_however_long():
    run = Integration(Stepper(AxisParameters()), at_rest(0.5), 1e-6)
    run.advance(60.0)
    steps = run.steps
    run.advance(86400.0)
    assert run.steps - steps < 100


def test_a_load_that_rattles_in_its_play_goes_on():
    # so slow that the shortest step moves it by less than rounding
    run = Integration(Stepper(replace(STICKY, gravity_nm=0.0)), at_rest(0.5), 1e-5)
    run.state[DEMAND_SPEED] = 2e-4
    run.advance(6.0)
    assert 10 < run.events < 100
    assert run.steps < 10_000
