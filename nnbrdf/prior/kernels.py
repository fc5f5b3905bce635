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
    a, b = np.sqrt(3) * a / scales, np.sqrt(3) * b / scales
    distance = _squared_distance(a, b)
    np.sqrt(distance, out=distance)
    result = np.exp(-distance)
    distance += 1
    result *= distance
    return result


def exchange(a: Pairs, b: Pairs, *, isotropic: bool) -> Array:
    """Return the covariance of c(light) - c(view), the simplest breach of reciprocity.

    c is a smooth random function of one direction (of its polar angle alone where `isotropic`),
    scaled to half the variance each; shape (len(a), len(b)).
    """
    tilts, scale = (_polar, _POLAR_SCALE) if isotropic else (_tilt, _TILT_SCALE)

    def between(pairs: Pairs) -> tuple[Array, NDArray[np.int64], NDArray[np.int64]]:
        both = tilts(np.concatenate([pairs.light, pairs.view]))
        if len(b) == 1:  # a column: sorting would take longer than what it saves
            return both, *np.arange(len(both)).reshape(2, -1)
        # a rig goes to few directions many times
        distinct, which = np.unique(both, axis=0, return_inverse=True)
        light, view = which.reshape(2, -1)
        return distinct, light, view

    (u, u_light, u_view), (w, w_light, w_view) = between(a), between(b)
    smooth = 0.5 * np.exp(-0.5 * _squared_distance(u, w) / scale**2)
    rows = smooth[u_light] - smooth[u_view]
    return np.asarray(rows[:, w_light] - rows[:, w_view])


def _polar(directions: Array) -> Array:
    return np.asarray(np.arccos(directions[:, 2:].clip(-1, 1)))


def _tilt(directions: Array) -> Array:
    return directions[:, :2]


def _squared_distance(a: Array, b: Array) -> Array:
    squared = a @ (-2 * b.T)
    squared += (a**2).sum(1)[:, None]
    squared += (b**2).sum(1)
    return np.maximum(squared, 0.0, out=squared)


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
