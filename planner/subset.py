"""Spreading a few directions over the hemisphere: greedy farthest point."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SAME_ANGLE = 9
"""Decimals of a radian to which angles count as equal, so that ties do not hang on round-off."""


def angles_between(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the great-circle distances of unit vectors (n, 3) and (m, 3) in radians, (n, m)."""
    # by arctangent: an arccosine loses half the digits at small angles
    cross = np.linalg.norm(np.cross(a[:, None], b[None]), axis=-1)
    return np.asarray(np.arctan2(cross, a @ b.T))


def farthest_from(directions: NDArray[np.float64], others: NDArray[np.float64]) -> int:
    """Return the index of the direction whose nearest of `others` is farthest; ties to the lowest.

    Both are unit vectors, shapes (n, 3) and (m, 3).
    """
    gap = angles_between(directions, others).min(axis=1)
    return int(np.argmax(gap.round(_SAME_ANGLE)))


def farthest_points(directions: NDArray[np.float64], count: int, start: int) -> NDArray[np.int64]:
    """Choose directions so that each is as far as can be from those chosen before it.

    The greedy 2-approximation of the k-centre problem (Gonzalez 1985).

    Parameters
    ----------
    directions
        Unit vectors, shape (n, 3).
    count
        How many to choose, 1 to n.
    start
        Index of the first.

    Returns
    -------
    ndarray
        Their indices, rising, shape (count,).
    """
    chosen = [start]
    while len(chosen) < count:
        chosen.append(farthest_from(directions, directions[chosen]))
    return np.sort(np.array(chosen, dtype=np.int64))
