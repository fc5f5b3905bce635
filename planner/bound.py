"""What no choice of pairs can beat: a lower bound on the variance left."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from planner.information import Unknown

_STEPS = 60
MOST_PAIRS = 40_000
"""Of more pairs a bound would take longer than the choice."""


def least_left(
    kinds: Sequence[Unknown], allowed: NDArray[np.bool_], chosen: NDArray[np.int64]
) -> float:
    """Return what any choice of as many pairs leaves at least, as `Unknown.remaining` adds up.

    Weights between 0 and 1 on the pairs make the variance left a convex function, so that its
    slope at any weights bounds it everywhere. The weights start at the choice and go towards the
    best by conditional gradients (Frank and Wolfe 1956; for designs Fedorov 1972). Products of
    views and lights are choices of pairs, too, so the bound holds for them as well.

    Parameters
    ----------
    kinds
        Of any state; their state afterwards means nothing.
    allowed
        Which pairs may be measured, shape (pairs,).
    chosen
        The choice, indices of pairs.
    """
    weights = np.zeros(len(allowed))
    weights[chosen] = 1.0
    bound = 0.0
    for step in range(_STEPS):
        for kind in kinds:
            kind.weigh(weights)
        slopes = np.where(allowed, sum(kind.slopes() for kind in kinds), -np.inf)
        steepest = np.zeros(len(allowed))
        steepest[np.argpartition(-slopes, len(chosen) - 1)[: len(chosen)]] = 1.0
        towards = steepest - weights
        left = sum(kind.remaining for kind in kinds)
        bound = max(bound, left - float(np.where(allowed, slopes, 0.0) @ towards))
        weights += towards * 2 / (step + 4)
    return bound
