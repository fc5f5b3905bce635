"""Criteria by which directions are chosen, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from gonio.errors import BadInputError
from planner.subset import farthest_from, farthest_points

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Choice(NamedTuple):
    """Indices of the chosen directions, rising: shapes (views,) and (lights,)."""

    views: NDArray[np.int64]
    lights: NDArray[np.int64]


class Criterion(Protocol):
    """Chooses the views and the lights of a product of the two."""

    def choose(
        self,
        view_candidates: NDArray[np.float64],
        light_candidates: NDArray[np.float64],
        views: int,
        lights: int,
    ) -> Choice:
        """Choose `views` and `lights` of the candidates, unit vectors of shape (n, 3) each."""


class FarthestPoint:
    """Each direction as far as can be from those before it: knows nothing of the material.

    The lights start at the first candidate, the pole. The views start at the candidate farthest
    from the chosen lights: were the two sets equal, every pair of different directions would be
    measured twice, since a BRDF is reciprocal.
    """

    def choose(
        self,
        view_candidates: NDArray[np.float64],
        light_candidates: NDArray[np.float64],
        views: int,
        lights: int,
    ) -> Choice:
        """Choose by great-circle distance (see `planner.subset.farthest_points`)."""
        light = farthest_points(light_candidates, lights, start=0)
        start = farthest_from(view_candidates, light_candidates[light])
        return Choice(farthest_points(view_candidates, views, start), light)


CRITERIA: dict[str, Criterion] = {"farthest": FarthestPoint()}


def criterion_named(name: str) -> Criterion:
    """Return a criterion.

    Raises
    ------
    BadInputError
        For an unknown name, listing the known.
    """
    if name not in CRITERIA:
        raise BadInputError(f"criterion {name!r} is not known; use {', '.join(CRITERIA)}")
    return CRITERIA[name]


def reciprocal_pairs(measured: NDArray[np.bool_]) -> int:
    """Count the unordered pairs of different directions that are measured both ways round.

    Parameters
    ----------
    measured
        Shape (n, n), indexed [light, view] over one and the same set of directions.
    """
    return int(np.triu(measured & measured.T, k=1).sum())
