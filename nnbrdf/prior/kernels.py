"""Covariances of what the generated materials do not say: smooth deviation, lack of reciprocity."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nnbrdf.prior.geometry import Pairs

    Array = NDArray[np.float64]

ISOTROPIC_SCALES = np.array([0.12, 0.25, 0.5, 0.3, 0.6])
ANISOTROPIC_SCALES = np.array([0.12, 0.12, 0.25, 0.5, 0.3, 0.5, 0.6, 0.6, 0.6])
_TILT_SCALE = 0.6
_POLAR_SCALE = 0.35


def isotropic_features(pairs: Pairs) -> Array:
    """Return five numbers that exchange, rotation and mirroring leave alone, shape (n, 5)."""
    return np.stack(
        [
            np.hypot(pairs.half[:, 0], pairs.half[:, 1]),
            *_cosines(pairs),
            pairs.cos_difference,
            pairs.cos_between,
        ],
        axis=1,
    )


def anisotropic_features(pairs: Pairs) -> Array:
    """Return nine numbers that exchange of light and view leaves alone, shape (n, 9)."""
    lx, ly, vx, vy = *pairs.light[:, :2].T, *pairs.view[:, :2].T
    return np.stack(
        [
            pairs.half[:, 0],
            pairs.half[:, 1],
            *_cosines(pairs),
            pairs.cos_difference,
            (lx * vy - ly * vx) ** 2,
            lx * vx,
            ly * vy,
            lx * vy + ly * vx,
        ],
        axis=1,
    )


def matern(a: Array, b: Array, scales: Array) -> Array:
    """Return the Matern covariance of order 3/2 and unit variance, shape (len(a), len(b))."""
    a, b = a / scales, b / scales
    squared = (a**2).sum(1)[:, None] + (b**2).sum(1) - 2 * a @ b.T
    distance = np.sqrt(3 * squared.clip(0.0))
    return np.asarray((1 + distance) * np.exp(-distance))


def exchange(a: Pairs, b: Pairs, *, isotropic: bool) -> Array:
    """Return the covariance of c(light) - c(view), the simplest breach of reciprocity.

    c is a smooth random function of one direction (of its polar angle alone where `isotropic`),
    scaled to half the variance each; shape (len(a), len(b)).
    """

    def smooth(u: Array, w: Array) -> Array:
        if isotropic:
            u, w = np.arccos(u[:, 2:].clip(-1, 1)), np.arccos(w[:, 2:].clip(-1, 1))
            scale = _POLAR_SCALE
        else:
            u, w, scale = u[:, :2], w[:, :2], _TILT_SCALE
        squared = (u**2).sum(1)[:, None] + (w**2).sum(1) - 2 * u @ w.T
        return np.asarray(np.exp(-0.5 * squared.clip(0.0) / scale**2))

    same = smooth(a.light, b.light) + smooth(a.view, b.view)
    return 0.5 * (same - smooth(a.light, b.view) - smooth(a.view, b.light))


def _cosines(pairs: Pairs) -> tuple[Array, Array]:
    light, view = pairs.light[:, 2].clip(0.0, 1.0), pairs.view[:, 2].clip(0.0, 1.0)
    return np.sqrt(light * view), light + view


def exchange_variance(pairs: Pairs, *, isotropic: bool) -> Array:
    """Return the diagonal of `exchange(pairs, pairs)`, shape (n,)."""
    if isotropic:
        apart = (
            np.arccos(pairs.light[:, 2].clip(-1, 1)) - np.arccos(pairs.view[:, 2].clip(-1, 1))
        ) ** 2
        scale = _POLAR_SCALE
    else:
        apart = ((pairs.light - pairs.view)[:, :2] ** 2).sum(1)
        scale = _TILT_SCALE
    return np.asarray(1 - np.exp(-0.5 * apart / scale**2))
