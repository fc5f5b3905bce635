"""The compiled search: what it is given is checked, what it returns holds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import _route
from planner.local_search import improve
from planner.metric import TimeMetric
from planner.places import Places

from .rigs import WIDE, rig_of

TIMES = np.array([[0, 5], [7, 0]])
STILL = np.zeros((1, 1), np.int64)
METRIC = _route.Metric(TIMES, 0 * TIMES, STILL, STILL)
POSES = np.array([[0, 0], [1, 0]])
GIVEN = {
    "view_places": [[0], [1]],
    "light_places": [[0]],
    "directions": POSES,
    "poses": POSES,
    "order": np.array([0, 1]),
}
WRONG = [
    ({"order": np.array([0, 0])}, "every shot once"),
    ({"order": np.array([0, 2])}, "every shot once"),
    ({"order": np.array([0])}, "every shot"),
    ({"poses": np.array([[0, 0], [2, 0]])}, "no such place"),
    ({"poses": np.array([[0, 0]])}, "needs a pose"),
    ({"directions": np.array([[0, 0], [-1, 0]])}, "no such place"),
    ({"directions": np.array([0, 1])}, "shape"),
    ({"view_places": [[0]]}, "needs its places"),
    ({"view_places": [[0], [2]]}, "no such place"),
]


def run(**changes):
    return _route.search(METRIC, METRIC, **(GIVEN | changes), work=1000, seed=0)


def test_the_better_of_two_directions_is_taken():
    order, poses = run(order=np.array([1, 0]))
    assert order.tolist() == [0, 1]
    assert poses.tolist() == POSES.tolist()


@pytest.mark.parametrize(("changes", "says"), WRONG)
def test_what_does_not_fit_is_refused(changes, says):
    with pytest.raises(ValueError, match=says):
        run(**changes)


def test_tables_and_moves_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="square and alike"):
        _route.Metric(TIMES, STILL, STILL, STILL)
    with pytest.raises(ValueError, match="a start, a goal and a time"):
        METRIC.override(POSES, POSES[:1], np.array([1, 1]))
    with pytest.raises(ValueError, match="without a direction"):
        _route.bound(METRIC, POSES, np.array([0, 1]))


@given(
    st.integers(1, 40), st.sampled_from([0.0, 5.0]), st.sampled_from([WIDE, (0.0, 359.0)]),
    st.integers(0, 2**32), st.sampled_from([0, 1000, 100_000]), st.booleans(),
)  # fmt: skip
def test_a_search_ends_no_longer_than_it_began(count, approach_deg, travel, seed, work, blocked):
    rng = np.random.default_rng(seed)
    rig = rig_of(travel, approach_deg=approach_deg)
    angles_deg = np.stack(
        [15.0 * rng.integers(0, 6, count), 5.0 * rng.integers(0, 70, count)] * 2, axis=1
    )
    arms = (
        Places.of(angles_deg[:, :2], rig.axis.view_phi),
        Places.of(angles_deg[:, 2:], rig.axis.light_phi),
    )
    metric = TimeMetric.between_places(*arms, rig)
    if blocked:
        slow = rng.integers(0, count, (2, 30))
        metric = metric.with_slow(*metric.poses[slow], rng.choice([1.0, 100.0, np.inf], 30))
    order = rng.permutation(count)
    better, route = improve(metric, arms, order, work, seed)
    assert sorted(route.tolist()) == list(range(count))
    assert better.total(route) <= metric.total(order)
    for arm, places in enumerate(arms):
        owner = np.searchsorted(places.first, better.poses[:, arm], side="right") - 1
        assert (owner == places.direction).all()
