"""What is expected to stay unknown after a plan: inside what a scene asks for, and outside."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from planner.information import NOISE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.protocols import PriorKind
    from planner.scene.quantities import Array


_CHUNK = 1 << 14
"""Pairs at once: of a thousand directions a side there are a million."""


class Expected(NamedTuple):
    """Expected standard deviation of ln(BRDF) after the measurements.

    Attributes
    ----------
    inside
        Mean over the pairs, weighted by the demand.
    outside
        Mean over the pairs that the scene does not ask for; None where it asks for all.
    """

    inside: float
    outside: float | None


def expected_error(
    kinds: Sequence[PriorKind],
    measured: NDArray[np.bool_],
    demand: Array,
    asked: NDArray[np.bool_],
) -> Expected:
    """Return what measuring some pairs is expected to leave unknown.

    Parameters
    ----------
    kinds
        Prior covariance at all pairs, light by light.
    measured, asked
        Which pairs are measured, and which the scene asks for, shape (lights, views).
    demand
        Weight of each pair, shape (lights, views), adding up to one.
    """
    deviation = sum(kind.share * _deviation(kind, measured) for kind in kinds)
    deviation = np.asarray(deviation).reshape(measured.shape)
    outside = float(deviation[~asked].mean()) if not asked.all() else None
    return Expected(float((demand * deviation).sum()), outside)


def _deviation(kind: PriorKind, measured: NDArray[np.bool_]) -> Array:
    """Return the posterior standard deviation at each pair, shape (pairs,)."""
    rows = kind.factor[kind.which[np.flatnonzero(measured)]].astype(np.float64)
    covariance = np.linalg.inv(np.eye(rows.shape[1]) + rows.T @ rows / NOISE)
    variance = np.empty(len(kind.factor))
    for start in range(0, len(variance), _CHUNK):
        some = kind.factor[start : start + _CHUNK]
        variance[start : start + _CHUNK] = ((some @ covariance) * some).sum(axis=1)
    if kind.rest is not None:
        times = np.bincount(kind.which[np.flatnonzero(measured)], minlength=len(variance))
        variance += kind.rest * NOISE / (times * kind.rest + NOISE)
    return np.asarray(np.sqrt(variance.clip(min=0.0))[kind.which])
