"""The shortest route of few shots, exactly: dynamic programming over sets (Held, Karp 1962)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from planner.metric import TimeMetric
    from planner.places import Places

    Indices = NDArray[np.int64]
    Array = NDArray[np.float64]

FEW = 6
"""Up to so many shots: at two poles, each may stand at hundreds of places."""


def shortest(metric: TimeMetric, arms: tuple[Places, Places]) -> tuple[TimeMetric, Indices]:
    """Return the metric with each shot at its best place, and the order that takes least time.

    Parameters
    ----------
    metric
        Between all places, of no more than `FEW` shots: work grows as 2^n.
    arms
        The places of view and light.
    """
    stands = [_stands(arms, shot) for shot in range(len(metric))]
    step_s = {
        (a, b): metric.times(stands[a][:, None], stands[b][None])
        for a in range(len(stands))
        for b in range(len(stands))
        if a != b
    }
    # least time to have taken a set of shots and stand at each place of its last one
    least_s: dict[tuple[int, int], Array] = {
        (1 << shot, shot): np.zeros(len(stand)) for shot, stand in enumerate(stands)
    }
    came_from: dict[tuple[int, int], tuple[Indices, Indices]] = {}
    whole = (1 << len(stands)) - 1
    for taken in range(1, whole):
        for last in _shots_in(taken, len(stands)):
            for shot in _shots_in(whole & ~taken, len(stands)):
                total_s = least_s[taken, last][:, None] + step_s[last, shot]
                _keep_better((taken | 1 << shot, shot), total_s, last, least_s, came_from)
    last = min(range(len(stands)), key=lambda shot: float(least_s[whole, shot].min()))
    return _traced(metric, stands, last, int(least_s[whole, last].argmin()), came_from)


def _keep_better(
    key: tuple[int, int],
    total_s: Array,
    last: int,
    least_s: dict[tuple[int, int], Array],
    came_from: dict[tuple[int, int], tuple[Indices, Indices]],
) -> None:
    """Keep, for each place of the shot that is reached, the quickest way there."""
    at, now_s = total_s.argmin(axis=0), total_s.min(axis=0)
    before_s = least_s.get(key)
    if before_s is None:
        least_s[key], came_from[key] = now_s, (np.full(len(at), last), at)
        return
    better = now_s < before_s
    shots, places = came_from[key]
    least_s[key] = np.where(better, now_s, before_s)
    came_from[key] = np.where(better, last, shots), np.where(better, at, places)


def _traced(
    metric: TimeMetric,
    stands: list[Indices],
    last: int,
    at: int,
    came_from: dict[tuple[int, int], tuple[Indices, Indices]],
) -> tuple[TimeMetric, Indices]:
    poses, order, taken = metric.poses.copy(), [last], (1 << len(stands)) - 1
    poses[last] = stands[last][at]
    while (taken, last) in came_from:
        shots, places = came_from[taken, last]
        taken, last, at = taken & ~(1 << last), int(shots[at]), int(places[at])
        order.append(last)
        poses[last] = stands[last][at]
    return replace(metric, poses=poses), np.array(order[::-1])


def _stands(arms: tuple[Places, Places], shot: int) -> Indices:
    """Return all poses in which a shot can be taken, shape (k, 2)."""
    view, light = (each.choices[each.direction[shot]] for each in arms)
    return np.stack(np.meshgrid(view, light, indexing="ij"), axis=-1).reshape(-1, 2)


def _shots_in(members: int, count: int) -> list[int]:
    return [shot for shot in range(count) if members >> shot & 1]
