"""What no route can beat, to say how good one is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from planner.search import is_available, tree_bound_s

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from planner.metric import TimeMetric

_ASSIGNED = 1500
"""Most shots of which the assignment bound is asked: its time grows with their cube."""


def bound_s(metric: TimeMetric, order: NDArray[np.int64]) -> float:
    """Return the best lower bound known of the seconds of any route.

    Parameters
    ----------
    metric
        Between shots, whose places are free to choose: see `TimeMetric.least`.
    order
        A good route, shape (n,).
    """
    bounds = [0.0]
    if len(order) > 1 and is_available():
        bounds.append(tree_bound_s(metric.either_way, order))
    if len(order) > 1 and len(order) <= _ASSIGNED and not metric.is_symmetric:
        bounds.append(assignment_bound_s(metric))
    return max(bounds)


def assignment_bound_s(metric: TimeMetric) -> float:
    """Return the least seconds in which each shot has one that follows it, in rings or not."""
    from scipy.optimize import linear_sum_assignment

    everything = np.arange(len(metric))
    # one more shot, nowhere, closes the route; no shot follows itself
    cost_s = np.pad(metric.between(everything[:, None], everything[None]), (0, 1))
    np.fill_diagonal(cost_s, cost_s.sum() + 1.0)
    rows, columns = linear_sum_assignment(cost_s)
    return float(cost_s[rows, columns].sum())
