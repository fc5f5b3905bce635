"""The way from one pose to another: straight on where that is free, else round about."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.approach import first_stop_deg
from gonio.clearance import check_pose, limits_of, not_free, spoken
from gonio.detours import leg_seconds, turned_round, ways_round, with_approach
from gonio.errors import BadInputError
from gonio.rig import AXES
from gonio.roadmap import roadmap_of
from gonio.swept import leg_blocked

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from gonio.rig import Rig

    Array = NDArray[np.float64]

_FIRST, _MORE = 16, 4
"""How many of the quickest ways round are looked at first, and how many times more after that."""

_SAME_DEG = 1e-9


@dataclass(frozen=True)
class Way:
    """A way of the arms.

    Attributes
    ----------
    poses_deg
        The poses after the start, shape (k, 4), the goal last; the arms stop at each.
    seconds
        What it takes, without settling; the approach to the goal (`approach_deg`) is included.
    """

    poses_deg: NDArray[np.float64]
    seconds: float


def blocked(starts_deg: ArrayLike, goals_deg: ArrayLike, rig: Rig) -> NDArray[np.bool_]:
    """Return which moves cannot go straight from start to goal, shape (n,).

    The axes start together; those with an `approach_deg` go beyond their goal first, if need be.
    Where the rig has neither separation nor boxes, none is blocked.

    Parameters
    ----------
    starts_deg, goals_deg
        Poses, shape (n, 4) each.
    """
    starts, goals = np.asarray(starts_deg, np.float64), np.asarray(goals_deg, np.float64)
    if not limits_of(rig):
        return np.zeros(len(starts), dtype=bool)
    return _any_blocked(with_approach(np.stack([starts, goals], axis=1), rig), rig)


def free_way(start_deg: ArrayLike, goal_deg: ArrayLike, rig: Rig) -> Way:
    """Return the way from pose to pose: straight on, or else the quickest free way round.

    Ways round are those of `gonio.detours.ways_round`; where none of them is free, those to the
    goal with an azimuth a whole turn away, the same direction. A start that is not free, as a home
    switch may be, is left on a leg on which nothing gets worse.

    Parameters
    ----------
    start_deg, goal_deg
        Poses, shape (4,) each.

    Raises
    ------
    BadInputError
        When the goal is not free, or no way to it is; naming both.
    """
    start, goal = np.asarray(start_deg, np.float64), np.asarray(goal_deg, np.float64)
    check_pose(goal, rig)
    if not blocked(start[None], goal[None], rig)[0]:
        return _way(np.stack([start, goal]), rig)
    for end in (goal, *turned_round(goal, rig)):
        found = _way_round(start, end, rig)
        if found is not None:
            return _way(found, rig)
    raise BadInputError(
        f"there is no free way from {spoken(start)} to {spoken(goal)}: every one that was tried "
        "touches a keep-out box or brings the arms too near to each other; leave out one of the "
        "two, or correct the rig file if it is wrong"
    )


def _way_round(start: Array, goal: Array, rig: Rig) -> Array | None:
    """Return the quickest free way round, shape (k, 4) with the start, or None."""
    ways = ways_round(start, goal, rig)
    seconds = leg_seconds(with_approach(ways, rig), rig).sum(axis=1)
    order = np.argsort(seconds, kind="stable")
    first, count = 0, _FIRST
    while first < len(order):
        some = ways[order[first : first + count]]
        free = np.flatnonzero(_are_free(some, rig))
        if len(free):
            return np.asarray(some[free[0]])
        first, count = first + count, count * _MORE
    far = roadmap_of(rig).way(start, goal, rig)
    short = None if far is None else _shortened(far, rig)
    return None if short is None else _landed(short, rig)


def _shortened(way: Array, rig: Rig) -> Array | None:
    """Leave out the poses of a way, shape (k, 4), that need not be passed; None if it ends badly.

    The last leg may need an approach that the map knows nothing of.
    """
    kept, last = [0], len(way) - 1
    while kept[-1] < last:
        later = np.arange(last, kept[-1], -1)
        starts = np.broadcast_to(way[kept[-1]], (len(later), 4))
        hit = leg_blocked(starts, way[later], rig)
        hit[0] = blocked(starts[:1], way[-1:], rig)[0]
        if hit.all():
            return None
        kept.append(int(later[np.argmin(hit)]))
    return np.asarray(way[kept])


def _landed(way: Array, rig: Rig) -> Array | None:
    """Put in where axes come from that are at the goal's angle before, by the wrong side.

    Returns None where that is not free.
    """
    before, goal = way[-2], way[-1]
    landing = before.copy()
    for column, name in enumerate(AXES):
        axis = rig.axis[name]
        away = np.abs(way[:, column] - goal[column]) > axis.in_position_deg
        if away.any() and not away[-2]:
            last_away = way[np.flatnonzero(away)[-1], column]
            landing[column] = first_stop_deg(last_away, goal[column], axis)
    if np.allclose(landing, before, rtol=0.0, atol=_SAME_DEG):
        return way
    down, up = (
        leg_blocked(before[None], landing[None], rig),
        blocked(landing[None], goal[None], rig),
    )
    return None if down[0] or up[0] else np.stack([*way[:-1], landing, goal])


def _are_free(ways: Array, rig: Rig) -> NDArray[np.bool_]:
    """Return which ways, shape (n, k, 4), can be gone; their ends are not asked for."""
    passed = ways[:, 1:-1]
    stays = (passed == ways[:, :1]).all(axis=2)
    short = np.any(list(not_free(passed.reshape(-1, 4), rig).values()), axis=0)
    free = (stays | ~short.reshape(stays.shape)).all(axis=1)
    free[free] = ~_any_blocked(with_approach(ways[free], rig), rig)
    return np.asarray(free)


def _any_blocked(ways: Array, rig: Rig) -> NDArray[np.bool_]:
    """Return which ways, shape (n, k, 4), have a leg that is blocked."""
    starts, goals = ways[:, :-1].reshape(-1, 4), ways[:, 1:].reshape(-1, 4)
    moves = np.flatnonzero((starts != goals).any(axis=1))
    hit = np.zeros(len(starts), dtype=bool)
    hit[moves] = leg_blocked(starts[moves], goals[moves], rig)
    return np.asarray(hit.reshape(ways.shape[0], ways.shape[1] - 1).any(axis=1))


def _way(poses: Array, rig: Rig) -> Way:
    seconds = float(leg_seconds(with_approach(poses, rig), rig).sum())
    moved = (np.diff(poses, axis=0) != 0.0).any(axis=1)
    moved[-1] = True
    return Way(poses[1:][moved], seconds)
