import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.metric import TimeMetric

from .rigs import RIG, rig_of, route_s

poses = st.lists(
    st.tuples(*[st.floats(0, 90), st.floats(0, 359)] * 2), min_size=1, max_size=12
).map(np.array)


@given(poses, st.sampled_from([0.0, 5.0, -20.0]))
def test_a_move_takes_what_the_arm_takes(angles_deg, approach_deg):
    rig = rig_of(approach_deg=approach_deg)
    metric = TimeMetric.of(angles_deg, rig)
    assert metric.total(np.arange(len(metric))) == pytest.approx(route_s(angles_deg, rig))


def test_one_sided_approach_gives_moves_a_direction():
    angles_deg = np.array([[15.0, 90.0, 15.0, 0.0], [30.0, 90.0, 15.0, 0.0]])
    assert TimeMetric.of(angles_deg, RIG).is_symmetric
    metric = TimeMetric.of(angles_deg, rig_of(approach_deg=5.0))
    assert not metric.is_symmetric
    up, down = metric.between(np.array([0, 1]), np.array([1, 0]))
    # down by 20 deg and up by 5, each from rest to rest: both ramps, no cruise
    assert (up, down) == pytest.approx((2 * np.sqrt(15 / 20), 2.0 + 2 * np.sqrt(5 / 20)))


def test_slow_moves_replace_what_the_axes_would_take():
    angles_deg = np.array([[15.0 * i, 90.0, 15.0, 30.0 * i] for i in range(3)])
    metric = TimeMetric.of(angles_deg, RIG)
    poses = metric.poses
    slow = metric.with_slow(poses[[0, 1]], poses[[1, 2]], np.array([50.0, 60.0]))
    slower = slow.with_slow(poses[[1]], poses[[2]], np.array([70.0]))
    assert slow.total(np.arange(3)) == 110.0
    assert slower.total(np.arange(3)) == 120.0
    assert slower.total(np.arange(3)[::-1]) == metric.total(np.arange(3)[::-1])
    assert [each.tolist() for each in slower.slow_moves] == [
        poses[[0, 1]].tolist(),
        poses[[1, 2]].tolist(),
    ]
