"""Free ways of many legs: the quickest through a grid of poses, one axis moving at a time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gonio.clearance import not_free
from gonio.detours import axis_stops, leg_seconds
from gonio.rig import AXES
from gonio.swept import leg_blocked

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import Rig

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class Roadmap:
    """Free poses of a rig, and which of them neighbour each other by a free leg.

    Attributes
    ----------
    poses_deg
        Shape (n, 4).
    begin, end, seconds
        The legs, shape (m,) each: numbers of poses, and what they take.
    """

    poses_deg: Array
    begin: NDArray[np.int64]
    end: NDArray[np.int64]
    seconds: Array

    def way(self, start_deg: Array, goal_deg: Array, rig: Rig) -> Array | None:
        """Return the quickest way through the map, shape (k, 4) with both ends, or None."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import dijkstra

        count = len(self.poses_deg)
        on, on_s = _legs(np.broadcast_to(start_deg, (count, 4)), self.poses_deg, rig)
        off, off_s = _legs(self.poses_deg, np.broadcast_to(goal_deg, (count, 4)), rig)
        begin = np.concatenate([self.begin, np.full(len(on), count), off])
        end = np.concatenate([self.end, on, np.full(len(off), count + 1)])
        seconds = np.concatenate([self.seconds, on_s, off_s])
        graph = coo_array((seconds, (begin, end)), shape=(count + 2, count + 2)).tocsr()
        _, before = dijkstra(graph, indices=count, return_predecessors=True)
        if before[count + 1] < 0:
            return None
        passed, pose = [], before[count + 1]
        while pose != count:
            passed.append(pose)
            pose = before[pose]
        return np.stack([start_deg, *self.poses_deg[passed[::-1]], goal_deg])


@lru_cache(maxsize=4)
def roadmap_of(rig: Rig) -> Roadmap:
    """Return the map of a rig; it is made once."""
    axes = [axis_stops(name, rig) for name in AXES]
    poses = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 4)
    free = ~np.any(list(not_free(poses, rig).values()), axis=0)
    number = np.where(free, np.cumsum(free) - 1, -1).reshape([len(stops) for stops in axes])
    pairs = [
        np.stack([np.take(number, range(n - 1), i), np.take(number, range(1, n), i)], -1)
        for i, n in enumerate(number.shape)
    ]
    legs = np.concatenate([pair.reshape(-1, 2) for pair in pairs])
    legs = legs[(legs >= 0).all(axis=1)]
    # both ways: an axis that moves alone sweeps the same there and back
    begin, end = np.concatenate([legs, legs[:, ::-1]]).T
    poses = poses[free]
    kept, seconds = _legs(poses[begin], poses[end], rig)
    return Roadmap(poses, begin[kept], end[kept], seconds)


def _legs(start: Array, goal: Array, rig: Rig) -> tuple[NDArray[np.int64], Array]:
    """Return which legs are free, and the seconds of these."""
    kept = np.flatnonzero(~leg_blocked(start, goal, rig))
    # a leg of no time at all would be none to the search
    seconds = leg_seconds(np.stack([start[kept], goal[kept]], axis=1), rig)[:, 0]
    return kept, np.maximum(seconds, 1e-6)
