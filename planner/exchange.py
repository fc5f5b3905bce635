"""2-opt exchanges in NumPy: for one arm's places, and for routes where nothing was compiled."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from planner.metric import ArmTimes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from planner.metric import TimeMetric

_WORK = 100_000_000
"""Evaluations of the metric that one local search may make; a count, so that it repeats."""

_GAIN_S = 1e-9
"""What an exchange must save, so that round-off does not exchange for ever."""


def two_opt(metric: TimeMetric, order: NDArray[np.int64], work: int = _WORK) -> NDArray[np.int64]:
    """Reverse parts of a route as long as that saves time (Croes 1958).

    The route is closed through a shot that is nowhere, so its ends count as any other place.

    Parameters
    ----------
    metric
        Symmetric seconds between shots.
    order
        The route, shot numbers of shape (n,).
    work
        Bound on the evaluations of the metric.
    """
    nowhere = len(order)
    metric, tour = _with_nowhere(metric), np.append(order, nowhere)
    step_s = metric.between(tour, np.roll(tour, -1))
    place = rested = 0
    while rested < len(tour) and work > 0:
        other, gain_s = _best_exchange(metric, tour, step_s, place)
        work -= 2 * len(tour)
        if gain_s > _GAIN_S:
            low, high = sorted((place, other))
            tour[low + 1 : high + 1] = tour[low + 1 : high + 1][::-1].copy()
            step_s = metric.between(tour, np.roll(tour, -1))
            rested = 0
        else:
            place, rested = (place + 1) % len(tour), rested + 1
    start = int(np.argmax(tour == nowhere)) + 1
    return np.roll(tour, -start)[:-1]


def _with_nowhere(metric: TimeMetric) -> TimeMetric:
    """Return the metric with one more shot, no time away from any: where a route may end."""
    view, light = (
        ArmTimes(np.pad(arm.go_s, (0, 1)), np.pad(arm.run_s, (0, 1)))
        for arm in (metric.view, metric.light)
    )
    nowhere = [len(metric.view.go_s), len(metric.light.go_s)]
    return replace(
        metric,
        view=view,
        light=light,
        poses=np.vstack([metric.poses, nowhere]),
        # slow moves are kept by numbers that one more shot changes
        slow_keys=np.empty(0, np.int64),
        slow_s=np.empty(0),
    )


def _best_exchange(
    metric: TimeMetric, tour: NDArray[np.int64], step_s: NDArray[np.float64], place: int
) -> tuple[int, float]:
    """Return the step to exchange with the one from `place`, and the seconds that this saves."""
    after = np.roll(tour, -1)
    exchanged = metric.between(tour[place], tour) + metric.between(after[place], after)
    gain_s = step_s[place] + step_s - exchanged
    gain_s[place] = 0.0
    best = int(np.argmax(gain_s))
    return best, float(gain_s[best])
