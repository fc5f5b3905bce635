"""Exponentials of matrices: their laws, at steps from far below to far above the time constants."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from sim.dynamics.equations import linear_part
from sim.dynamics.modes import Mode
from sim.dynamics.operators import exponential_operators
from sim.dynamics.parameters import AxisParameters

MODES = [Mode(slides, flank, stop) for slides in (0, 1) for flank in (0, 1) for stop in (0, 1)]
STEP = st.floats(-7.0, 1.8).map(lambda power: 10.0**power)


@pytest.mark.parametrize("step_s", [1e-6, 1e-4, 1e-2])
@pytest.mark.parametrize("mode", MODES)
def test_they_are_what_scipy_makes_of_a_larger_matrix(mode, step_s):
    linear = linear_part(AxisParameters(), mode)
    n = len(linear)
    larger = np.zeros((3 * n, 3 * n))
    larger[:n, :n] = linear
    larger[:n, n : 2 * n] = larger[n : 2 * n, 2 * n :] = np.eye(n)
    whole = expm(step_s * larger)
    ours = exponential_operators(linear, step_s)
    theirs = whole[:n, :n] - np.eye(n), whole[:n, n : 2 * n], whole[:n, 2 * n :]
    for one, other in zip(ours, theirs, strict=True):
        assert np.abs(one - other).max() <= 1e-9 * np.abs(other).max()


@given(STEP, st.sampled_from(MODES))
def test_two_steps_are_one_of_twice_the_length(step_s, mode):
    linear = linear_part(AxisParameters(), mode)
    half, whole = (exponential_operators(linear, step) for step in (step_s, 2.0 * step_s))
    change = 2.0 * half.change + half.change @ half.change
    first = 2.0 * half.first + half.change @ half.first
    second = 2.0 * half.second + half.change @ half.second + step_s * half.first
    for one, other in zip(whole, (change, first, second), strict=True):
        assert np.abs(one - other).max() <= 1e-9 * np.abs(other).max()


@given(STEP, st.sampled_from(MODES))
def test_the_first_integral_undoes_the_matrix(step_s, mode):
    linear = linear_part(AxisParameters(), mode)
    operators = exponential_operators(linear, step_s)
    scale = np.abs(linear).max() * np.abs(operators.first).max()
    assert np.abs(linear @ operators.first - operators.change).max() <= 1e-11 * scale


@given(st.floats(-7.0, 4.0).map(lambda power: 10.0**power))
def test_a_slow_part_keeps_its_digits_beside_a_fast_one(step_s):
    operators = exponential_operators(np.diag([-1e4, -1e-3, 0.0]), step_s)
    slow = np.expm1(-1e-3 * step_s)
    assert operators.change[1, 1] == pytest.approx(slow, rel=1e-11)
    assert operators.change[2, 2] == 0.0
    assert operators.first[2, 2] == pytest.approx(step_s, rel=1e-14)
    assert operators.second[2, 2] == pytest.approx(0.5 * step_s**2, rel=1e-14)
