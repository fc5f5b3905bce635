"""Laws of motion in time, homing, and what an estimate is made of."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.eta import Budget
from gonio.homing import homing_time
from gonio.plan import LampSetting, Shot
from gonio.profile import s_curve_s, trapezoid_s
from gonio.rig import AXES, Rig, default_rig
from gonio.timemodel import estimate, move_time, route_times, still_times
from gonio.timing import AxesTiming, AxisTiming, Spread, Timing, default_timing

RIG = default_rig()
SPEED = st.floats(1e-3, 1e4)
ACCELERATION = st.floats(1e-3, 1e5)
JERK = st.floats(1e-3, 1e9)
WAY = st.floats(0.0, 3600.0)


def rig_with(**changes) -> Rig:
    """Return the built-in rig with fields replaced, by names with __ for the dot."""
    data = RIG.model_dump()
    for name, value in changes.items():
        *path, last = name.split("__")
        table = data
        for key in path:
            table = table[key]
        table[last] = value
    return Rig.model_validate(data)


def shots_at(*angles, exposures_s=(0.1,)):
    return [
        Shot(
            index=i,
            exposures_s=exposures_s,
            lamps=(LampSetting(n=1, mA=700),),
            **{f"{name}_deg": angle for name, angle in zip(AXES, pose, strict=True)},
        )
        for i, pose in enumerate(angles)
    ]


@given(WAY, WAY, SPEED, ACCELERATION, JERK)
def test_further_takes_longer(one, other, speed, acceleration, jerk):
    ways = np.array(sorted((one, other)))
    for times in (
        trapezoid_s(ways, speed, acceleration),
        s_curve_s(ways, speed, acceleration, jerk),
    ):
        assert np.isfinite(times).all()
        assert times[0] <= times[1] * (1 + 1e-12)


@given(WAY, SPEED, ACCELERATION, JERK)
def test_an_s_curve_is_never_quicker_than_its_trapezoid(way, speed, acceleration, jerk):
    trapezoid = trapezoid_s(np.array(way), speed, acceleration)
    assert s_curve_s(np.array(way), speed, acceleration, jerk) >= trapezoid * (1 - 1e-12)


@given(st.floats(1e-6, 3600.0), SPEED, ACCELERATION)
def test_it_tends_to_it_as_the_jerk_grows(way, speed, acceleration):
    trapezoid = trapezoid_s(np.array(way), speed, acceleration)
    late = [
        float(s_curve_s(np.array(way), speed, acceleration, jerk) - trapezoid)
        for jerk in (acceleration * 1e2, acceleration * 1e6, acceleration * 1e15)
    ]
    assert late[2] <= late[1] + 1e-9 * trapezoid
    assert late[1] <= late[0] + 1e-9 * trapezoid
    assert late[2] < 1e-6 * (1 + trapezoid)


@given(st.floats(1e-6, 3600.0), SPEED, ACCELERATION, JERK)
def test_two_ramps_and_a_cruise_make_the_way(way, speed, acceleration, jerk):
    def ramp_s(velocity):
        if velocity * jerk >= acceleration**2:
            return velocity / acceleration + acceleration / jerk
        return 2 * (velocity / jerk) ** 0.5

    # a ramp from rest covers its time at half the velocity; bisect for the one that just fits twice
    low, peak = 0.0, speed
    for _ in range(200):
        middle = (low + peak) / 2
        low, peak = (middle, peak) if middle * ramp_s(middle) < way else (low, middle)
    cruise_s = way / peak - ramp_s(peak)
    told = s_curve_s(np.array(way), speed, acceleration, jerk)
    assert told == pytest.approx(2 * ramp_s(peak) + cruise_s, rel=1e-6)


@given(WAY, JERK)
def test_either_way_takes_the_same(way, jerk):
    axis = default_timing(RIG).axis.view_phi.model_copy(update={"jerk_deg_s3": jerk})
    assert move_time(way, axis) == move_time(-way, axis)


def test_no_way_takes_no_time_and_a_tiny_one_hardly_more_than_the_latency():
    axis = default_timing(RIG).axis.view_theta
    assert move_time(0.0, axis) == 0.0
    assert move_time(1e-12, axis) == pytest.approx(axis.latency_s, abs=1e-6)
    assert move_time(1e-12, RIG.axis.view_theta) == pytest.approx(2e-6 / 20**0.5)


def test_an_axis_of_a_rig_file_acts_just_as_that_says():
    spec = RIG.axis.view_phi
    ways = np.array([0.5, 20.0, 300.0])
    assert move_time(ways, spec) == pytest.approx(move_time(ways, AxisTiming.nominal(spec)))


def with_settle(*means_s, ring_down_s=0.0):
    timing = default_timing(RIG)
    axes = {
        name: timing.axis[name].model_copy(update={"settle": Spread(mean_s=mean), "latency_s": 0.0})
        for name, mean in zip(AXES, means_s, strict=True)
    }
    return timing.model_copy(update={"axis": AxesTiming(**axes), "ring_down_s": ring_down_s})


def test_a_move_is_over_when_the_last_arm_is_still():
    timing = with_settle(5.0, 0.0, 0.0, 1.0)
    # view_theta arrives after 2 s and shakes for 5; light_phi arrives after 4 s and shakes for 1
    route = np.array([[0, 0, 0, 0], [20.0, 0, 0, 90.0], [20.0, 0, 0, 90.0]])
    assert route_times(route, RIG, timing) == pytest.approx([4.0, 0.0])
    assert still_times(route, RIG, timing) == pytest.approx([7.0, 0.0])


def test_two_stops_at_once_shake_longer_by_the_logarithm_of_two():
    timing = with_settle(1.0, 1.0, 1.0, 1.0, ring_down_s=0.2)
    both, far = (
        np.array([[0, 0, 0, 0], [20.0, 30.0, 0, 0.0]]),
        np.array([[0, 0, 0, 0], [20.0, 300, 0, 0]]),
    )
    assert still_times(both, RIG, timing) == pytest.approx([3.0 + 0.2 * np.log(2)])
    assert still_times(far, RIG, timing) == pytest.approx([11.0 + 1.0], abs=1e-6)


def test_a_one_sided_approach_makes_its_run_up_after_the_rest_has_arrived():
    rig = rig_with(axis__view_theta__approach_deg=5.0)
    # from 40 down to 20: to 15 first, while light_phi takes 3 s; then 5 deg up in 1 s
    route = np.array([[40.0, 0, 0, 0], [20.0, 0, 0, 60.0]])
    assert route_times(route, rig) == pytest.approx([3.0 + 1.0])
    assert route_times(route[::-1], rig) == pytest.approx([3.0])


def test_homing_is_as_long_as_that_of_the_axis_furthest_off():
    timing = default_timing(RIG)
    quick = AxisTiming.nominal(RIG.axis.view_theta).model_copy(
        update={"homing_velocity_deg_s": 1e5}
    )
    slow = quick.model_copy(update={"homing_velocity_deg_s": 10.0, "homing_s": 2.0})
    axes = AxesTiming(view_theta=quick, view_phi=slow, light_theta=quick, light_phi=quick)
    told = homing_time(RIG, timing.model_copy(update={"axis": axes}))
    # uniform from 5 to 375 deg: 2.5 to 39.5 s
    assert told.mean_s == pytest.approx(21.0, rel=1e-3)
    assert told.sd_s == pytest.approx(37.0 / 12**0.5, rel=1e-3)


def test_homing_by_drawing_lots():
    timing, random = default_timing(RIG), np.random.default_rng(0)
    times = []
    for name in AXES:
        spec, axis = RIG.axis[name], timing.axis[name]
        way = np.abs(random.uniform(spec.min_deg, spec.max_deg, 20000) - spec.to_degrees(0))
        times.append(axis.homing_s + way / axis.homing_velocity_deg_s)
    latest = np.max(times, axis=0)
    told = homing_time(RIG, timing)
    assert told.mean_s == pytest.approx(latest.mean(), rel=0.01)
    assert told.sd_s == pytest.approx(latest.std(), rel=0.02)


def test_independent_spreads_add_in_square_and_common_errors_as_they_are():
    budget = Budget()
    assert budget.add(Spread(mean_s=2.0, sd_s=3.0, error_s=0.1), 100) == 200.0
    assert budget.interval_s == pytest.approx((200 - 1.645 * 31.623, 200 + 1.645 * 31.623), 1e-3)
    budget.add(Spread(mean_s=1.0, error_s=2.0), 10)
    assert (budget.variance_s2, budget.common_s) == pytest.approx((900.0, 30.0))


def test_the_interval_never_begins_below_zero():
    budget = Budget()
    budget.add(Spread(mean_s=1.0, sd_s=50.0))
    assert budget.interval_s[0] == 0.0


def parts(estimates):
    names = ("moving_s", "settling_s", "exposing_s", "overhead_s", "homing_s")
    return [getattr(estimates, name) for name in names]


def test_a_measured_timing_is_named_and_another_is_not():
    shots = shots_at((45.0, 0, 0, 0))
    measured = default_timing(RIG).model_copy(update={"measured": True})
    assert estimate(shots, RIG).timing_sha256 is None
    assert estimate(shots, RIG, measured).timing_sha256 == measured.sha256


def test_common_errors_widen_what_many_moves_take():
    shots = shots_at(*((10.0 + 20 * (i % 2), 0, 0, 0) for i in range(400)))
    timing = default_timing(RIG)
    sure = timing.model_copy(update={"axis": AxesTiming(**{
        name: timing.axis[name].model_copy(update={"error": 0.0}) for name in AXES
    })})  # fmt: skip
    unsure = timing.model_copy(update={"axis": AxesTiming(**{
        name: timing.axis[name].model_copy(update={"error": 0.1}) for name in AXES
    })})  # fmt: skip
    narrow, wide = (estimate(shots, RIG, each) for each in (sure, unsure))
    assert narrow.total_s == wide.total_s
    assert wide.total_hi_s - wide.total_s > 0.1 * wide.moving_s
    assert narrow.total_hi_s - narrow.total_s < 0.1 * wide.moving_s


def test_a_read_out_that_the_next_move_covers_costs_nothing():
    timing = default_timing(RIG).model_copy(update={"read_out": Spread(mean_s=1.5)})
    far = shots_at((10.0, 0, 0, 0), (40.0, 0, 0, 0), (10.0, 0, 0, 0))
    near = shots_at(*[(10.0, 0, 0, 0)] * 3)
    frames = 3 + 8
    moved = estimate(far, RIG, timing)
    quick = timing.model_copy(update={"read_out": Spread(mean_s=0.0)})
    assert moved.overhead_s - estimate(far, RIG, quick).overhead_s == pytest.approx(
        1.5 * (frames - 2)
    )
    # where nothing moves, only the asking of the lamps covers some of it
    stood = estimate(near, RIG, timing).overhead_s - estimate(near, RIG, quick).overhead_s
    assert stood == pytest.approx(1.5 * frames - 2 * timing.lamps.mean_s)


def test_lamps_warm_up_after_each_rest():
    shots = shots_at(*((10.0 + 20 * (i % 2), 0, 0, 0) for i in range(120)), exposures_s=(1.0,))
    plain = estimate(shots, RIG)
    warm = estimate(shots, rig_with(lamps__warm_up_s=60.0))
    rests = estimate(
        shots, rig_with(lamps__warm_up_s=60.0, lamps__rest_after_s=200.0, lamps__rest_s=90.0)
    )
    assert warm.overhead_s - plain.overhead_s == pytest.approx(60.0)
    waited = rests.overhead_s - plain.overhead_s - 60.0
    # 120 shots of 4.2 s each with 140 s of light between two rests
    assert waited == pytest.approx(150.0 * 3)


EXTREME = {
    "slow": {"axis__view_theta__max_velocity_deg_s": 1e-3},
    "sluggish": {"axis__view_theta__max_acceleration_deg_s2": 1e-3},
    "fast": {"axis__view_theta__max_velocity_deg_s": 1e4},
    "violent": {"axis__view_theta__max_acceleration_deg_s2": 1e5},
    "loose": {"arm__settle_limit_urad": 6e4},
    "strict": {"arm__settle_limit_urad": 0.1},
}


@pytest.mark.parametrize("changes", EXTREME.values(), ids=EXTREME)
def test_extreme_rigs_get_sane_estimates(changes):
    rig = rig_with(**changes)
    told = estimate(shots_at((0, 0, 0, 0), (1e-6, 0, 0, 0), (90.0, 350.0, 75.0, 10.0)), rig)
    assert all(np.isfinite(part) and part >= 0 for part in parts(told))
    assert told.total_s == pytest.approx(sum(parts(told)))
    assert 0 <= told.total_lo_s <= told.total_s <= told.total_hi_s < 1e7


def test_weeks_add_up():
    shots = shots_at(*((10.0 + 20 * (i % 2), 0, 0, 0) for i in range(5000)), exposures_s=(300.0,))
    told = estimate(shots, RIG)
    assert told.total_s > 17 * 86400
    assert told.exposing_s == 300.0 * (5000 + 8)
    assert told.total_hi_s - told.total_lo_s < 0.01 * told.total_s


def test_the_shortest_exposure_counts_as_it_is():
    told = estimate(shots_at((0, 0, 0, 0), exposures_s=(1e-6,)), RIG)
    assert told.exposing_s == pytest.approx(9e-6)


def test_what_is_shipped_is_no_measurement():
    timing = default_timing(RIG)
    assert not timing.measured
    assert isinstance(timing, Timing)
    assert timing.white_level_s == pytest.approx(0.4)
    near = default_timing(rig_with(lamps__distance_m=1.0))
    assert near.white_level_s == pytest.approx(0.1)
