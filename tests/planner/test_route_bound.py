from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.local_search import tree_bound_s
from planner.metric import TimeMetric
from planner.places import Places
from planner.route_bound import assignment_bound_s, bound_s, nearest_bound_s

from .rigs import RIG, WIDE, between_s, least_s, rig_of

BOUNDS = {
    "nearest": nearest_bound_s,
    "assignment": assignment_bound_s,
    "tree": lambda metric: tree_bound_s(metric.either_way, np.arange(len(metric))),
    "best": lambda metric: bound_s(metric, np.arange(len(metric))),
}
poses = st.lists(st.tuples(*[st.floats(1, 90), st.floats(0, 359)] * 2), min_size=2, max_size=7).map(
    np.array
)


@pytest.mark.parametrize("bound", BOUNDS.values(), ids=BOUNDS)
@given(angles_deg=poses, approach_deg=st.sampled_from([0.0, 5.0, -40.0]))
def test_no_route_beats_a_bound(bound, angles_deg, approach_deg):
    rig = rig_of(approach_deg=approach_deg)
    least = least_s(between_s(angles_deg, rig))
    assert bound(TimeMetric.of(angles_deg, rig)) <= least * (1 + 1e-9)


@given(
    st.lists(st.tuples(*[st.sampled_from([0.0, 60.0]), st.sampled_from([5.0, 300.0])] * 2),
             min_size=2, max_size=3).map(np.array),
    st.sampled_from([0.0, 5.0]),
)  # fmt: skip
def test_nor_does_one_that_turns_the_axes(angles_deg, approach_deg):
    rig = rig_of(WIDE, approach_deg=approach_deg)
    view = Places.of(angles_deg[:, :2], rig.axis.view_phi)
    light = Places.of(angles_deg[:, 2:], rig.axis.light_phi)
    metric = TimeMetric.between_places(view, light, rig)
    directions = zip(view.direction, light.direction, strict=True)
    choices = [list(product(view.choices[v], light.choices[i])) for v, i in directions]
    stands = np.array(list(product(*choices)))
    starts, goals = stands[:, :, None], stands[:, None]
    least = min(least_s(times) for times in metric.times(starts, goals)[:2000])
    for name, bound in BOUNDS.items():
        assert bound(metric.least(view, light)) <= least * (1 + 1e-9), name


def test_a_line_of_shots_meets_its_bound():
    angles_deg = np.array([[75.0, 10.0 * i, 15.0, 0.0] for i in range(12)])
    metric = TimeMetric.of(angles_deg, RIG)
    best_s = metric.total(np.arange(12))
    assert bound_s(metric, np.arange(12)) == pytest.approx(best_s, abs=1e-6)
    assert nearest_bound_s(metric) == pytest.approx(best_s)


def test_a_poor_route_makes_no_bound_too_high():
    """Two heaps of shots: which moves join them at best is told by neither neighbours nor route."""
    phi = np.append(np.linspace(10, 40, 12), np.linspace(190, 220, 12))
    angles_deg = np.stack([np.full(24, 75.0), phi, np.full(24, 15.0), np.zeros(24)], axis=1)
    metric = TimeMetric.of(angles_deg, rig_of())
    best_s = metric.total(np.arange(24))
    # from the outer end of one heap to the outer end of the other
    poor = np.append(np.arange(12)[::-1], np.arange(12, 24)[::-1])
    assert metric.total(poor) > best_s + 1.0
    assert best_s - 1e-3 < tree_bound_s(metric, poor) <= best_s + 1e-9


def test_the_tree_is_nearer_than_the_rest_where_times_have_no_direction():
    angles_deg = np.random.default_rng(1).uniform(1, 75, (80, 4))
    metric = TimeMetric.of(angles_deg, RIG)
    tree, assignment, nearest = (BOUNDS[name](metric) for name in ("tree", "assignment", "nearest"))
    assert tree > 1.02 * assignment > 1.02 * nearest
