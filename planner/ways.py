"""What moves really take: those that something blocks go round about."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.clearance import limits_of
from gonio.detours import with_approach
from gonio.errors import BadInputError
from gonio.paths import blocked, free_way
from gonio.rig import AXES
from gonio.timemodel import move_time, route_times

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from gonio.rig import Rig
    from gonio.timing import Timing

    Array = NDArray[np.float64]


def seconds_of_ways(rig: Rig, timing: Timing) -> Callable[[Array, Array], Array] | None:
    """Return what tells the seconds of moves by free ways; None where nothing blocks any.

    It takes poses to start from and to go to, shape (n, 4) each, and returns shape (n,): infinity
    where there is no free way.
    """
    if not limits_of(rig):
        return None

    def way_s(starts_deg: Array, goals_deg: Array) -> Array:
        moves = np.stack([starts_deg, goals_deg], axis=1)
        seconds = np.array([route_times(move, rig, timing)[0] for move in moves])
        for i in np.flatnonzero(blocked(starts_deg, goals_deg, rig)):
            seconds[i] = _round_about_s(starts_deg[i], goals_deg[i], rig, timing)
        return seconds

    return way_s


def _round_about_s(start_deg: Array, goal_deg: Array, rig: Rig, timing: Timing) -> float:
    try:
        way = free_way(start_deg, goal_deg, rig)
    except BadInputError:
        return np.inf
    steps = np.diff(with_approach(np.vstack([start_deg, way.poses_deg]), rig), axis=0)
    times = [move_time(steps[:, i], timing.axis[name]) for i, name in enumerate(AXES)]
    return float(np.max(times, axis=0).sum())
