"""Criteria that know what materials look like: least variance or most information."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from planner.bound import MOST_PAIRS, least_left
from planner.budget import pairs_within
from planner.criteria import Choice
from planner.information import Unknown
from planner.pairing import product_of
from planner.search import Measure, best_pairs, best_product, classes_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from gonio.protocols import Prior, Progress
    from planner.budget import Terms
    from planner.field import Field

RANK = 150
"""Columns of the prior's factor: more leave the choice of 196 pairs as good and take longer."""

_VARIANCE = Measure(Unknown.gains, Unknown.block_gains)
_ENTROPY = Measure(Unknown.entropy_gains, Unknown.block_entropy_gains)


class _Optimal:
    """Choice by greedy growth and exchange under a prior (see `planner.search`).

    Parameters
    ----------
    prior
        Makes what is believed of the material.
    progress
        Called with the steps of the search done, and those there may be.
    """

    _measure: Measure

    def __init__(self, prior: Callable[[], Prior], progress: Progress | None = None) -> None:
        self._prior, self._progress = prior, progress

    def product(self, field: Field, lights: int, views: int) -> Choice:
        """Choose lights and views that grow side by side and are exchanged in turn."""
        allowed = field.allowed
        light, view = np.flatnonzero(allowed.any(axis=1)), np.flatnonzero(allowed.any(axis=0))
        if (lights, views) == (len(light), len(view)):
            return Choice(product_of(allowed, light, view))
        kinds = unknown_of(field, self._prior())
        light, view = best_product(
            kinds, allowed, lights, views, self._measure, progress=self._progress
        )
        return _judged(field, kinds, product_of(allowed, light, view))

    def pairs(self, field: Field, count: int) -> Choice:
        """Choose pairs one by one; of a pair and its reverse, equal by reciprocity, either in turn.

        Half of them each way round shows whether the material keeps reciprocity.
        """
        if count == field.allowed.sum():
            return Choice(field.allowed.copy())
        kinds = unknown_of(field, self._prior())
        chosen = best_pairs(
            kinds, field.allowed.ravel(), count, self._measure, progress=self._progress
        )
        measured = np.zeros_like(field.allowed)
        measured.flat[_either_way(chosen, classes_of(kinds), field.allowed.ravel())] = True
        return _judged(field, kinds, measured)

    def within(self, field: Field, seconds: float, terms: Terms) -> Choice:
        """Choose pairs by what they tell per second (see `planner.budget`)."""
        kinds = unknown_of(field, self._prior())
        priced = pairs_within(
            kinds, field.allowed.ravel(), seconds, terms, self._measure, self._progress
        )
        if priced is None:
            raise BadInputError(
                f"a capture of one shot takes more than {seconds / 3600:g} h, calibration and all; "
                "give more --hours"
            )
        measured = np.zeros_like(field.allowed)
        measured.flat[priced.order] = True
        return _judged(field, kinds, measured)


class IOptimal(_Optimal):
    """Least posterior variance of the logarithm of the BRDF, summed over the demand."""

    _measure = _VARIANCE


class DOptimal(_Optimal):
    """Least determinant of the posterior covariance of the logarithm: most information.

    It asks what the measurements tell together, whatever they tell it of; a demand changes nothing
    in that.
    """

    _measure = _ENTROPY


def unknown_of(field: Field, prior: Prior) -> list[Unknown]:
    """Return what is unknown of each kind of material of a prior, at all pairs of a field."""
    demand = None if field.demand is None else field.demand.ravel()
    return [Unknown(kind, demand) for kind in prior.kinds(*field.pairs, RANK)]


def _judged(field: Field, kinds: list[Unknown], measured: NDArray[np.bool_]) -> Choice:
    chosen = np.flatnonzero(measured & field.allowed)
    for kind in kinds:
        kind.forget(chosen)
    left = float(sum(kind.remaining for kind in kinds))
    if measured.size > MOST_PAIRS:
        return Choice(measured, left)
    return Choice(measured, left, least_left(kinds, field.allowed.ravel(), chosen))


def _either_way(
    chosen: NDArray[np.int64], classes: NDArray[np.int64], allowed: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Replace each pair by one drawn from those equal to it, no pair twice."""
    rng = np.random.default_rng(0)
    equal = np.flatnonzero(allowed & np.isin(classes, classes[chosen]))
    shuffled = rng.permutation(equal)
    ranks = shuffled[np.argsort(classes[shuffled], kind="stable")]
    wanted, counts = np.unique(classes[chosen], return_counts=True)
    starts = np.searchsorted(classes[ranks], wanted)
    return np.sort(np.concatenate([ranks[s : s + n] for s, n in zip(starts, counts, strict=True)]))
