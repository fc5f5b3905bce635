"""First routes: the nearest neighbour always, or one arm to and fro while the other stands."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from planner.exchange import two_opt
from planner.metric import ArmTimes, TimeMetric

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Indices = NDArray[np.int64]


def first_routes(metric: TimeMetric) -> dict[str, Indices]:
    """Return some routes by name, shot numbers of shape (n,) each."""
    view, light = metric.poses.T
    return {
        "nearest neighbour": nearest_neighbour(metric),
        "snake of views": snake(light, metric.light, view, metric.view),
        "snake of lights": snake(view, metric.view, light, metric.light),
    }


def nearest_neighbour(metric: TimeMetric) -> Indices:
    """Go from the first shot always to the nearest that is left; ties to the lowest number."""
    order = np.zeros(len(metric), dtype=np.int64)
    left = np.arange(1, len(metric))
    for position in range(1, len(metric)):
        nearest = int(np.argmin(metric.between(order[position - 1], left)))
        order[position] = left[nearest]
        left = np.delete(left, nearest)
    return order


def snake(slow: Indices, slow_times: ArmTimes, fast: Indices, fast_times: ArmTimes) -> Indices:
    """Let one arm stand while the other goes through its places, to and fro.

    `slow` and `fast` are the place that each shot has of either arm, shape (n,); `slow_times` and
    `fast_times` tell how far these are apart.
    """
    slow_rank = _ranks(slow, slow_times)
    fast_rank = _ranks(fast, fast_times)
    return np.lexsort((np.where(slow_rank % 2, -fast_rank, fast_rank), slow_rank))


def _ranks(places: Indices, times: ArmTimes) -> Indices:
    """Return how far on a short path through all the places that occur each of them comes."""
    there, at = np.unique(places, return_inverse=True)
    square = np.ix_(there, there)
    metric = TimeMetric.of_one_arm(ArmTimes(times.go_s[square], times.run_s[square])).either_way
    return np.argsort(two_opt(metric, nearest_neighbour(metric)))[at.reshape(-1)]
