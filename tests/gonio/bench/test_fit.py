"""Fits of what was measured: they find what made the times, and say how well."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gonio.bench.fit import fit_line, fit_profile, fit_ring_down
from gonio.errors import DeviceFaultError
from gonio.profile import s_curve_s, trapezoid_s

WAYS = np.repeat(np.geomspace(0.5, 300.0, 8), 2) * np.tile([1.0, -1.0], 8)


@settings(max_examples=25)
@given(st.floats(0.5, 2.0), st.floats(0.5, 2.0), st.floats(0.01, 0.5))
def test_a_trapezoid_is_found(speed, ramp, latency):
    velocity, acceleration = 30.0 * speed, 30.0 * ramp
    times = latency + trapezoid_s(np.abs(WAYS), velocity, acceleration)
    found = fit_profile(WAYS, times, 30.0, 30.0)
    assert found[:3] == pytest.approx((latency, velocity, acceleration), rel=1e-3)
    assert found.jerk_deg_s3 == 0.0
    assert found.residual_s < 1e-4
    assert found.times(np.abs(WAYS)) == pytest.approx(times)


@settings(max_examples=25)
@given(st.floats(0.5, 2.0), st.floats(0.2, 2.0))
def test_an_s_curve_is_told_from_a_trapezoid(speed, onset):
    # one whose acceleration is never reached has none to be told
    assume(onset <= speed)
    velocity, acceleration = 30.0 * speed, 30.0
    jerk = acceleration / onset
    times = 0.08 + s_curve_s(np.abs(WAYS), velocity, acceleration, jerk)
    found = fit_profile(WAYS, times, 30.0, 30.0)
    assert found.jerk_deg_s3 > 0
    assert found.times(np.abs(WAYS)) == pytest.approx(times, rel=2e-3)
    assert found.velocity_deg_s == pytest.approx(velocity, rel=0.1)


def test_noise_is_in_the_residual_and_in_the_uncertainty():
    random = np.random.default_rng(1)
    times = 0.08 + trapezoid_s(np.abs(WAYS), 30.0, 30.0) + 0.02 * random.standard_normal(len(WAYS))
    found = fit_profile(WAYS, times, 30.0, 30.0)
    assert found.residual_s == pytest.approx(0.02, rel=0.6)
    assert found.jerk_deg_s3 == 0.0
    off = np.abs(found.times(np.abs(WAYS)) / (0.08 + trapezoid_s(np.abs(WAYS), 30.0, 30.0)) - 1)
    assert 0.2 * off.mean() < found.error < 5 * off.mean()


def test_an_axis_much_slower_than_it_is_said_to_be():
    times = 0.1 + trapezoid_s(np.abs(WAYS), 3.0, 2.0)
    found = fit_profile(WAYS, times, 30.0, 30.0)
    assert (found.velocity_deg_s, found.acceleration_deg_s2) == pytest.approx((3.0, 2.0), rel=1e-3)


def test_times_that_are_none_are_refused():
    with pytest.raises(DeviceFaultError, match="fit no profile"):
        fit_profile(WAYS, np.full(len(WAYS), np.nan), 30.0, 30.0)


def test_homing_from_further_away_takes_longer_or_is_refused():
    way = np.array([10.0, 20.0, 40.0])
    assert fit_line(way, 1.5 + way / 8.0) == pytest.approx((1.5, 8.0))
    with pytest.raises(DeviceFaultError, match="takes no longer"):
        fit_line(way, 5.0 - way / 100.0)


def test_ringing_down_behind_a_window():
    times = np.arange(0.0, 2.0, 0.02)
    shaking = np.round(200.0 * np.exp(-np.maximum(times - 0.5, 0.0) / 0.17))
    assert fit_ring_down(times, shaking) == pytest.approx(0.17, rel=0.1)


@pytest.mark.parametrize("shaking", [np.zeros(20), np.full(20, 7.0), np.arange(20.0), np.empty(0)])
def test_an_arm_that_does_not_ring_down(shaking):
    assert fit_ring_down(np.arange(float(len(shaking))), shaking) == 0.0
