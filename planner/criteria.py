"""Criteria by which directions are chosen, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from gonio.errors import BadInputError
from planner.information import Unknown, best_pairs, best_product
from planner.subset import farthest_from, farthest_points

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from gonio.protocols import Prior

RANK = 150
"""Columns of the prior's factor: more leave the choice of 196 pairs as good and take longer."""


class Choice(NamedTuple):
    """What was chosen.

    Attributes
    ----------
    measured
        Which pairs, shape (n, n), indexed [light, view].
    variance_left
        Share of the prior's variance that they leave, where the criterion knows a prior.
    """

    measured: NDArray[np.bool_]
    variance_left: float | None = None


class Criterion(Protocol):
    """Chooses what to measure among pairs of n directions."""

    def product(self, allowed: NDArray[np.bool_], views: int, lights: int) -> Choice:
        """Choose `views` and `lights` directions; every allowed pair of them is measured.

        `allowed` says which pairs the rig can take, shape (n, n), indexed [light, view].
        """

    def pairs(self, allowed: NDArray[np.bool_], count: int) -> Choice:
        """Choose `count` of the allowed pairs."""


class FarthestPoint:
    """Each direction as far as can be from those before it: knows nothing of the material.

    The lights start at the first candidate, the pole. The views start at the candidate farthest
    from the chosen lights: were the two sets equal, every pair of different directions would be
    measured twice, since a BRDF is reciprocal.

    Parameters
    ----------
    directions
        Unit vectors, shape (n, 3).
    """

    def __init__(self, directions: NDArray[np.float64]) -> None:
        self._directions = directions

    def product(self, allowed: NDArray[np.bool_], views: int, lights: int) -> Choice:
        """Choose by great-circle distance (see `planner.subset.farthest_points`)."""
        light_reach = np.flatnonzero(allowed.any(axis=1))
        view_reach = np.flatnonzero(allowed.any(axis=0))
        light_candidates, view_candidates = (
            self._directions[reach] for reach in (light_reach, view_reach)
        )
        light = farthest_points(light_candidates, lights, start=0)
        start = farthest_from(view_candidates, light_candidates[light])
        view = farthest_points(view_candidates, views, start)
        return Choice(_product(allowed, light_reach[light], view_reach[view]))

    def pairs(self, allowed: NDArray[np.bool_], count: int) -> Choice:
        """Refuse: distances on the hemisphere do not rank pairs."""
        raise BadInputError(
            f"criterion farthest chooses views and lights, not {count} pairs of them; "
            "use --criterion i-optimal, or --views and --lights"
        )


class IOptimal:
    """Least posterior variance of the logarithm of the BRDF, over all pairs, under a prior.

    Parameters
    ----------
    directions
        Unit vectors, shape (n, 3).
    prior
        Makes what is believed of the material.
    """

    def __init__(self, directions: NDArray[np.float64], prior: Callable[[], Prior]) -> None:
        self._directions, self._prior = directions, prior

    def product(self, allowed: NDArray[np.bool_], views: int, lights: int) -> Choice:
        """Choose by greedy growth and exchange (see `planner.information.best_product`)."""
        light, view = np.flatnonzero(allowed.any(axis=1)), np.flatnonzero(allowed.any(axis=0))
        if (lights, views) == (len(light), len(view)):
            return Choice(_product(allowed, light, view))
        unknown = self._unknown()
        light, view = best_product(unknown, allowed, lights, views)
        return Choice(_product(allowed, light, view), _left(unknown))

    def pairs(self, allowed: NDArray[np.bool_], count: int) -> Choice:
        """Choose one by one; of a pair and its reverse, equal by reciprocity, either in turn.

        Half of them each way round shows whether the material keeps reciprocity.
        """
        unknown = self._unknown()
        once = allowed & ~(allowed.T & np.tri(len(allowed), k=-1, dtype=bool))
        chosen = best_pairs(unknown, once.ravel(), min(count, int(once.sum())))
        measured = np.zeros_like(allowed)
        measured.flat[chosen] = True
        measured = _mixed(measured, allowed)
        rest = np.flatnonzero((allowed & ~measured).ravel())
        measured.flat[rest[: count - int(measured.sum())]] = True
        return Choice(measured, _left(unknown))

    def _unknown(self) -> list[Unknown]:
        count = len(self._directions)
        light = np.repeat(self._directions, count, axis=0)
        view = np.tile(self._directions, (count, 1))
        return [Unknown(kind) for kind in self._prior().kinds(light, view, RANK)]


def _product(
    allowed: NDArray[np.bool_], light: NDArray[np.int64], view: NDArray[np.int64]
) -> NDArray[np.bool_]:
    chosen = np.zeros_like(allowed)
    chosen[np.ix_(light, view)] = True
    return chosen


def _mixed(measured: NDArray[np.bool_], allowed: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Turn about half of the pairs round, where the rig can take them so."""
    turn = measured & allowed.T & (np.random.default_rng(0).random(measured.shape) < 0.5)
    return np.asarray((measured & ~turn) | turn.T)


def _left(unknown: list[Unknown]) -> float:
    return float(sum(kind.remaining for kind in unknown))


CRITERIA = ("i-optimal", "farthest")


def criterion_named(
    name: str, directions: NDArray[np.float64], prior: Callable[[], Prior] | None = None
) -> Criterion:
    """Return a criterion over directions, unit vectors of shape (n, 3).

    Parameters
    ----------
    name
        One of `CRITERIA`.
    prior
        Makes the prior, where the criterion wants one.

    Raises
    ------
    BadInputError
        For an unknown name, listing the known, and for `i-optimal` without a prior.
    """
    if name not in CRITERIA:
        raise BadInputError(f"criterion {name!r} is not known; use {', '.join(CRITERIA)}")
    if name == "farthest":
        return FarthestPoint(directions)
    if prior is None:
        raise BadInputError("criterion i-optimal needs a prior; use farthest, or pass one")
    return IOptimal(directions, prior)


def reciprocal_pairs(measured: NDArray[np.bool_]) -> int:
    """Count the unordered pairs of different directions that are measured both ways round.

    Parameters
    ----------
    measured
        Shape (n, n), indexed [light, view] over one and the same set of directions.
    """
    return int(np.triu(measured & measured.T, k=1).sum())
