from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gonio.rig import default_rig
from gonio.timemodel import route_times
from planner.metric import TimeMetric
from planner.route import nearest_neighbour, plan_route, snake, two_opt

RIG = default_rig()

angles = st.lists(
    st.tuples(
        st.sampled_from([0.0, 15.0, 30.0, 75.0]), st.sampled_from([0.0, 90.0, 180.0, 345.0]),
        st.sampled_from([0.0, 15.0, 30.0, 75.0]), st.sampled_from([0.0, 90.0, 180.0, 345.0]),
    ),
    min_size=1,
    max_size=30,
    unique=True,
).map(np.array)  # fmt: skip


def seconds(angles_deg):
    return route_times(angles_deg, RIG).sum()


@given(angles)
def test_the_metric_is_the_rigs_time_model(angles_deg):
    metric = TimeMetric.of(angles_deg, RIG)
    assert metric.total(np.arange(len(angles_deg))) == pytest.approx(seconds(angles_deg))


@given(angles)
@settings(deadline=None)
def test_each_shot_is_taken_once_and_no_slower_than_by_nearest_neighbour(angles_deg):
    route = plan_route(angles_deg, RIG)
    assert sorted(route.order.tolist()) == list(range(len(angles_deg)))
    neighbour = angles_deg[nearest_neighbour(TimeMetric.of(angles_deg, RIG))]
    assert seconds(angles_deg[route.order]) <= seconds(neighbour) + 1e-6


@given(angles, st.randoms(use_true_random=False))
@settings(deadline=None)
def test_no_reversal_of_a_part_is_left_that_saves_time(angles_deg, random):
    order = list(range(len(angles_deg)))
    random.shuffle(order)
    metric = TimeMetric.of(angles_deg, RIG)
    better = two_opt(metric, np.array(order))
    total = metric.total(better)
    assert total <= metric.total(np.array(order)) + 1e-6
    for low in range(len(better)):
        for high in range(low + 2, len(better) + 1):
            other = better.copy()
            other[low:high] = other[low:high][::-1]
            assert metric.total(other) >= total - 1e-6


def test_few_shots_get_the_best_route_of_all():
    angles_deg = np.array(
        [[0, 0, 0, 0], [75, 0, 75, 0], [15, 90, 15, 0], [75, 90, 30, 0], [30, 180, 0, 0]], float
    )
    best = min(seconds(angles_deg[list(order)]) for order in permutations(range(5)))
    assert seconds(angles_deg[plan_route(angles_deg, RIG).order]) == pytest.approx(best)


def test_the_local_search_stops_at_its_bound():
    rng = np.random.default_rng(1)
    angles_deg = rng.uniform(0, 75, (200, 4))
    metric = TimeMetric.of(angles_deg, RIG)
    order = np.arange(200)
    assert (two_opt(metric, order, work=0) == order).all()
    some, all_ = (metric.total(two_opt(metric, order, work=w)) for w in (20_000, 10**8))
    assert metric.total(order) > some > all_


def test_a_snake_moves_one_arm_at_a_time():
    slow, fast = (index.ravel() for index in np.mgrid[:3, :4])
    times_s = np.abs(np.subtract.outer(np.arange(4.0), np.arange(4.0)))
    order = snake(slow, times_s[:3, :3], fast, times_s)
    steps = np.abs(np.diff(slow[order])) + np.abs(np.diff(fast[order]))
    assert (steps == 1).all()


def test_settled_rings_are_followed_step_by_step():
    """A lone arm on a ring goes round it, never across."""
    phi = np.arange(24) * 15.0
    angles_deg = np.stack([np.full(24, 75.0), phi, np.zeros(24), np.zeros(24)], axis=1)
    shuffled = angles_deg[np.random.default_rng(3).permutation(24)]
    steps = np.diff(shuffled[plan_route(shuffled, RIG).order][:, 1])
    assert (np.abs(steps) == 15.0).all()
