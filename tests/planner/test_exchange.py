import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from planner.construct import snake
from planner.exchange import two_opt
from planner.metric import ArmTimes, TimeMetric

from .rigs import RIG

angles = st.lists(
    st.tuples(*[st.sampled_from([0.0, 15.0, 75.0]), st.sampled_from([0.0, 90.0, 345.0])] * 2),
    min_size=1,
    max_size=20,
    unique=True,
).map(np.array)


@given(angles, st.randoms(use_true_random=False))
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


def test_it_stops_at_its_bound():
    angles_deg = np.random.default_rng(1).uniform(0, 75, (200, 4))
    metric = TimeMetric.of(angles_deg, RIG)
    order = np.arange(200)
    assert (two_opt(metric, order, work=0) == order).all()
    some, all_ = (metric.total(two_opt(metric, order, work=w)) for w in (20_000, 10**8))
    assert metric.total(order) > some > all_


def test_a_snake_moves_one_arm_at_a_time():
    slow, fast = (index.ravel() for index in np.mgrid[:3, :4])
    times_s = np.abs(np.subtract.outer(np.arange(4.0), np.arange(4.0)))
    times = ArmTimes(times_s, np.zeros_like(times_s))
    order = snake(slow, times, fast, times)
    steps = np.abs(np.diff(slow[order])) + np.abs(np.diff(fast[order]))
    assert (steps == 1).all()
