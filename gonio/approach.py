"""One-sided approach: where an axis goes first, so that backlash always lies on the same side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from gonio.rig import Axis


def first_stop_deg(starts_deg: ArrayLike, goals_deg: ArrayLike, axis: Axis) -> NDArray[np.float64]:
    """Return where an axis goes before its goal: the goal itself where it needs no run-up.

    An axis with an `approach_deg` ends each move with at least that much way, signed; where its
    travel ends before, the run-up is shorter.

    Parameters
    ----------
    starts_deg, goals_deg
        Angles of the axis, broadcast against each other.
    axis
        Its travel, run-up and tolerance count.
    """
    starts, goals = np.broadcast_arrays(
        np.asarray(starts_deg, np.float64), np.asarray(goals_deg, np.float64)
    )
    run_up = axis.approach_deg
    if not run_up:
        return np.array(goals)
    way = goals - starts
    # a long enough way from the right side needs no detour, nor does an axis that stays
    detours = (np.abs(way) > axis.in_position_deg) & (way / run_up < 1.0)
    return np.where(detours, np.clip(goals - run_up, axis.min_deg, axis.max_deg), goals)
