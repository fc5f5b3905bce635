"""Where more time begins to buy less: the knee of error against time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.report.pareto import Point, pareto_front

if TYPE_CHECKING:
    from collections.abc import Sequence

_LEAST = 3
_STRAIGHT = 1e-9


def knee(points: Sequence[Point]) -> Point | None:
    """Return the point of the front that lies deepest below the line from its first to its last.

    Both axes run from 0 to 1 over the front (Kneedle: Satopaa et al. 2011), of the error by its
    logarithm: a minute is a minute anywhere, an error counts by its ratio to another. None where
    fewer than three points are on the front, or all are on a straight line or above.
    """
    front = pareto_front(points)
    if len(front) < _LEAST:
        return None
    both = np.array([(point.seconds, np.log(point.error)) for point in front])
    time, error = ((both - both.min(axis=0)) / np.ptp(both, axis=0)).T
    depth = 1.0 - time - error
    deepest = int(np.argmax(depth))
    return front[deepest] if depth[deepest] > _STRAIGHT else None


def best_within(points: Sequence[Point], seconds: float) -> Point | None:
    """Return the point of least error within a time, the quickest of equals."""
    within = [point for point in points if point.seconds <= seconds]
    return min(within, key=lambda p: (p.error, p.seconds), default=None)
