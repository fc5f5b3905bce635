"""What no route can beat, to say how good one is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from planner.local_search import is_available, tree_bound_s

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from planner.metric import TimeMetric

_ASSIGNED = 1500
"""Most shots of which the assignment bound is asked: its time grows with their cube."""


def bound_s(metric: TimeMetric, order: NDArray[np.int64]) -> float:
    """Return the best lower bound known of the seconds of any route.

    Where moves have no direction, trees with prices are nearest to the truth; assignments where
    they have.

    Parameters
    ----------
    metric
        Between shots, whose places are free to choose: see `TimeMetric.least`.
    order
        A good route, shape (n,).
    """
    if len(order) < 2:
        return 0.0
    bounds = [nearest_bound_s(metric)]
    if is_available():
        bounds.append(tree_bound_s(metric.either_way, order))
    if len(order) <= _ASSIGNED and not (is_available() and metric.is_symmetric):
        bounds.append(assignment_bound_s(metric))
    return max(bounds)


def nearest_bound_s(metric: TimeMetric) -> float:
    """Return half the seconds of each shot's least move to another and least move from another.

    The last shot is not left and the first not entered: the longest of either is not counted.
    """
    out_s, in_s = np.empty((2, len(metric)))
    everything = np.arange(len(metric))
    for shot in everything:
        others = np.delete(everything, shot)
        out_s[shot] = metric.between(shot, others).min()
        in_s[shot] = metric.between(others, shot).min()
    return float((out_s.sum() - out_s.max() + in_s.sum() - in_s.max()) / 2.0)


def assignment_bound_s(metric: TimeMetric) -> float:
    """Return the least seconds in which each shot has one that follows it, in rings or not."""
    from scipy.optimize import linear_sum_assignment

    everything = np.arange(len(metric))
    # one more shot, nowhere, closes the route; no shot follows itself
    cost_s = np.pad(metric.between(everything[:, None], everything[None]), (0, 1))
    np.fill_diagonal(cost_s, 2.0 * cost_s.max() + 1.0)
    return float(cost_s[linear_sum_assignment(cost_s)].sum())
