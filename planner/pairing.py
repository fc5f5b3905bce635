"""Which directions may join a product of lights and views so that no pair of it is lost."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Chosen = Sequence[int] | NDArray[np.int64]


def may_join(
    allowed: NDArray[np.bool_],
    chosen: tuple[Chosen, Chosen],
    wanted: tuple[int, int],
    axis: int,
) -> NDArray[np.bool_]:
    """Return which directions cost the product the fewest pairs, at least one.

    What one costs is the pairs that it loses with those chosen on the other side, and the
    directions that the other side would still be short of, had each to pair with all on this side.
    So a choice made one by one loses no pair as long as there is a direction that keeps them all,
    and does not run out of such directions on the other side without need.

    Parameters
    ----------
    allowed
        Which pairs the rig can take, shape (L, V).
    chosen
        Rows (lights) and columns (views) chosen so far.
    wanted
        How many lights and views there will be.
    axis
        0: a light is to join; 1: a view.

    Returns
    -------
    ndarray
        Shape (allowed.shape[axis],); never true for one that is chosen already, or that takes part
        in no allowed pair.
    """
    table = allowed if axis == 0 else allowed.T
    own, others = list(chosen[axis]), list(chosen[1 - axis])
    free = np.array(table.any(axis=1))
    free[own] = False
    lost = (~table[:, others]).sum(axis=1)
    common = np.array(table[own].all(axis=0))
    common[others] = False
    short = wanted[1 - axis] - len(others) - table @ common.astype(np.int64)
    cost = lost + np.maximum(short, 0)
    return np.asarray(free & (cost == cost[free].min(initial=table.size)))


def product_of(allowed: NDArray[np.bool_], lights: Chosen, views: Chosen) -> NDArray[np.bool_]:
    """Return all pairs of some lights and some views, of the shape of `allowed`."""
    pairs = np.zeros_like(allowed)
    pairs[np.ix_(np.asarray(lights), np.asarray(views))] = True
    return pairs
