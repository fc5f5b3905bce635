"""Which turn of an axis, and at the pole which azimuth, makes a route in its order shortest."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from planner.metric import TimeMetric
    from planner.places import Places

    Indices = NDArray[np.int64]

_SWEEPS = 4


def with_best_places(metric: TimeMetric, order: Indices, arms: tuple[Places, Places]) -> TimeMetric:
    """Return the metric with each shot at the places, view and light, that suit a route best.

    For one arm at a time, the other as it is, by dynamic programming along the route (Bellman
    1957), in turns until neither gains; never longer than before.

    Parameters
    ----------
    metric
        Between all places.
    order
        The route, shot numbers of shape (n,).
    arms
        The places of view and light.
    """
    for _ in range(_SWEEPS):
        before = metric.total(order)
        for arm, places in enumerate(arms):
            choices = places.choices
            mine = [choices[direction] for direction in places.direction[order].tolist()]
            poses = metric.poses.copy()
            poses[order, arm] = _along(metric, metric.poses[order], arm, mine)
            moved = replace(metric, poses=poses)
            metric = moved if moved.total(order) < metric.total(order) else metric
        if metric.total(order) >= before:
            break
    return metric


def _along(metric: TimeMetric, route: Indices, arm: int, choices: Sequence[Indices]) -> Indices:
    """Return the best place of one arm at each pose of a route, shape (n,)."""
    step_s = metric.times(route[:-1], route[1:])
    there = _stand(route[0], arm, choices[0])
    least_s, came_from = np.zeros(len(there)), []
    for i in range(1, len(route)):
        here, there = there, _stand(route[i], arm, choices[i])
        if len(here) == len(there) == 1:
            least_s = least_s + step_s[i - 1]
            came_from.append(np.zeros(1, np.int64))
            continue
        total_s = least_s[:, None] + metric.times(here[:, None], there[None])
        came_from.append(total_s.argmin(axis=0))
        least_s = total_s.min(axis=0)
    at = [int(least_s.argmin())]
    for back in reversed(came_from):
        at.append(int(back[at[-1]]))
    return np.array([mine[i] for mine, i in zip(choices, reversed(at), strict=True)])


def _stand(pose: Indices, arm: int, places: Indices) -> Indices:
    """Return the poses, shape (k, 2), that differ from `pose` in the place of one arm."""
    poses = np.repeat(pose[None], len(places), axis=0)
    poses[:, arm] = places
    return poses
