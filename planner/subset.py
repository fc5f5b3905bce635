"""Spreading a few directions over the hemisphere: farthest point, least energy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import ArrayLike, NDArray

    MayJoin = Callable[[Sequence[int]], ArrayLike]

_SAME_ANGLE = 9
"""Decimals of a radian to which angles count as equal, so that ties do not hang on round-off."""

_SAME_ENERGY = 1e-9
_CLOSE = 1e-2
_SWEEPS = 10


def _anything(_: Sequence[int]) -> bool:
    return True


def angles_between(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the great-circle distances of unit vectors (n, 3) and (m, 3) in radians, (n, m)."""
    # by arctangent: an arccosine loses half the digits at small angles
    cross = np.linalg.norm(np.cross(a[:, None], b[None]), axis=-1)
    return np.asarray(np.arctan2(cross, a @ b.T))


def farthest_from(
    directions: NDArray[np.float64], others: NDArray[np.float64], among: ArrayLike = True
) -> int:
    """Return the index of the direction whose nearest of `others` is farthest; ties to the lowest.

    Both are unit vectors, shapes (n, 3) and (m, 3); only those of `among`, shape (n,), count.
    """
    gap = angles_between(directions, others).min(axis=1).round(_SAME_ANGLE)
    return int(np.argmax(np.where(among, gap, -1.0)))


def farthest_points(
    directions: NDArray[np.float64], count: int, start: int, may: MayJoin = _anything
) -> NDArray[np.int64]:
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
    may
        Which directions may join those chosen so far.

    Returns
    -------
    ndarray
        Their indices, rising, shape (count,).
    """
    chosen = [start]
    while len(chosen) < count:
        chosen.append(farthest_from(directions, directions[chosen], may(chosen)))
    return np.sort(np.array(chosen, dtype=np.int64))


def least_energy(
    directions: NDArray[np.float64],
    count: int,
    others: NDArray[np.float64] | None = None,
    may: MayJoin = _anything,
) -> NDArray[np.int64]:
    """Choose directions that repel each other, and are repelled by `others`.

    Greedy growth, then exchange of each in turn for the best there is, as long as the Riesz energy
    of order 3 (the sum of distance^-3 over all two) falls.

    Parameters
    ----------
    directions
        Unit vectors, shape (n, 3).
    count
        How many to choose, 1 to n.
    others
        Unit vectors that repel them, too, shape (m, 3).
    may
        Which directions may join those chosen so far.

    Returns
    -------
    ndarray
        Their indices, rising, shape (count,).
    """
    push = _repulsion(directions, directions)
    np.fill_diagonal(push, 0.0)
    outside = 0.0 if others is None else _repulsion(directions, others).sum(axis=1)
    energy = outside + np.zeros(len(directions))
    chosen: list[int] = []
    for _ in range(count):
        _take(chosen, energy, push, may)
    for _ in range(_SWEEPS):
        before = sorted(chosen)
        for index in list(chosen):
            chosen.remove(index)
            energy -= push[index]
            _take(chosen, energy, push, may)
        if sorted(chosen) == before:
            break
    return np.sort(np.array(chosen, dtype=np.int64))


def _take(
    chosen: list[int], energy: NDArray[np.float64], push: NDArray[np.float64], may: MayJoin
) -> None:
    """Add the direction of least energy, ties to the lowest index; `energy` follows."""
    free = np.where(may(chosen), energy, np.inf)
    free[chosen] = np.inf
    least = free.min()
    best = int(np.argmax(free <= least * (1 + _SAME_ENERGY)))
    chosen.append(best)
    energy += push[best]


def _repulsion(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    # 2 sin(angle / 2): the chord, which does not lose digits as a difference of vectors would
    chord = 2 * np.sin(angles_between(a, b) / 2)
    return np.asarray(np.maximum(chord, _CLOSE) ** -3.0)
