"""How much a scene asks for each pair of candidate directions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from planner.subset import angles_between

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from planner.candidates import Candidates
    from planner.scene.pairs import LocalPairs
    from planner.scene.quantities import Array

LEFT_OUT_SHARE = 0.01
"""Share of the demand that pairs left out as not asked for may have together."""

_WIDTH = 0.5
"""Standard deviation of the smoothing, in spacings of the candidates."""


@dataclass(frozen=True)
class Demand:
    """Weights of pairs of candidates.

    Attributes
    ----------
    weights
        What reaches the eye by each pair, shape (lights, views); adds up to one.
    reverse
        The same where each pair is taken the other way round, light for view: to a reciprocal
        material that is the same value, so measuring either tells of both.
    lights, views
        The candidates, as unit vectors, shapes (lights, 3) and (views, 3).
    """

    weights: Array
    reverse: Array
    lights: Array
    views: Array

    @classmethod
    def of(cls, pairs: LocalPairs, lights: Candidates, views: Candidates) -> Demand:
        """Give each sample to the nearest candidate light and the nearest candidate view."""
        both = (lights.directions, views.directions)
        weights = _binned(pairs.light, pairs.view, pairs.weight, *both)
        return cls(weights, _binned(pairs.view, pairs.light, pairs.weight, *both), *both)

    def asked(self, left_out: float = LEFT_OUT_SHARE) -> NDArray[np.bool_]:
        """Return which pairs tell of what the scene asks for, shape (lights, views).

        Demand, either way round, is smoothed by the spacing of the candidates; those with least
        are left out, as long as together they hold no more than `left_out` of it.
        """
        smooth: Array = (
            _smoothing(self.lights) @ (self.weights + self.reverse) @ _smoothing(self.views).T
        )
        order = np.argsort(smooth, axis=None, kind="stable")
        held = np.cumsum(smooth.flat[order])
        dropped = order[held <= left_out * held[-1]]
        # what has demand of its own and not only by its neighbours is rounding below this
        asked: NDArray[np.bool_] = smooth > 1e-12 * smooth.max()
        asked.flat[dropped] = False
        return asked


def _binned(light: Array, view: Array, weight: Array, lights: Array, views: Array) -> Array:
    cell = _nearest(light, lights) * len(views) + _nearest(view, views)
    size = len(lights) * len(views)
    weights = np.asarray(np.bincount(cell, weights=weight, minlength=size), np.float64)
    return np.asarray(weights / weights.sum()).reshape(len(lights), len(views))


def _nearest(direction: Array, candidates: Array) -> NDArray[np.int64]:
    from scipy.spatial import cKDTree

    return np.asarray(cKDTree(candidates).query(direction)[1], np.int64)


def _smoothing(candidates: Array) -> Array:
    """Return weights that spread each candidate's demand over its neighbours, shape (n, n)."""
    angle = angles_between(candidates, candidates)
    if len(candidates) == 1:
        return np.ones((1, 1))
    spacing = np.median(np.where(np.eye(len(angle), dtype=bool), np.inf, angle).min(axis=1))
    kernel = np.exp(-0.5 * (angle / (_WIDTH * max(spacing, 1e-6))) ** 2)
    return np.asarray(kernel / kernel.sum(axis=0))
