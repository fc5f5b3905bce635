"""The legs of a route: where a move cannot go straight, the arms stop on the way."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from gonio.paths import blocked, free_way

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import Rig

    Array = NDArray[np.float64]


def legs_of(angles_deg: Array, rig: Rig) -> tuple[Array, NDArray[np.int64]]:
    """Return all poses of a route, those on ways round included, and which leg begins each move.

    A move that has no free way, which a capture refuses, counts as straight.

    Parameters
    ----------
    angles_deg
        Poses to be at, shape (n, 4).

    Returns
    -------
    poses_deg, begins
        Shapes (k, 4), k at least n, and (n - 1,).
    """
    hits = blocked(angles_deg[:-1], angles_deg[1:], rig)
    if not hits.any():
        return angles_deg, np.arange(len(hits))
    poses, begins = [angles_deg[0]], []
    for number, hit in enumerate(hits):
        begins.append(len(poses) - 1)
        goal, straight = angles_deg[number + 1], (poses[-1] == angles_deg[number]).all()
        # a way may end with an azimuth a turn away, from where the next one starts
        poses += [goal] if straight and not hit else _way(poses[-1], goal, rig)
    return np.array(poses), np.array(begins)


def _way(start: Array, goal: Array, rig: Rig) -> list[Array]:
    try:
        return list(free_way(start, goal, rig).poses_deg)
    except BadInputError:
        return [goal]
