"""Inputs made of the half vector, for networks that know what a material does not depend on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Inputs = Callable[[Array, Array], Array]

_SHARPEST = 0.01


def isotropic(light: Array, view: Array) -> Array:
    """Return five inputs that exchange, rotation and mirroring leave alone.

    The half vector's sine, and its logarithm so that narrow lobes are told apart; the geometric
    mean and the sum of both cosines; the cosine between light and half vector.

    Parameters
    ----------
    light, view
        Unit vectors, shape (n, 3).

    Returns
    -------
    ndarray
        Shape (n, 5).
    """
    half, cos_difference = _half(light, view)
    squared = half[:, 0] ** 2 + half[:, 1] ** 2
    sharp = 0.25 * np.log(squared + _SHARPEST)
    columns = [np.sqrt(squared), *_cosines(light, view), cos_difference, sharp]
    return np.stack(columns, axis=1)


def anisotropic(light: Array, view: Array) -> Array:
    """Return eight inputs that exchange of light and view leaves alone, shape (n, 8).

    The half vector's x and y; the geometric mean and the sum of both cosines; what remains of the
    azimuths: lx vx - ly vy, lx vy + ly vx, the cosine between light and half vector, and the
    square of lx vy - ly vx. Parameters as for `isotropic`.
    """
    half, cos_difference = _half(light, view)
    lx, ly, vx, vy = *light[:, :2].T, *view[:, :2].T
    return np.stack(
        [
            half[:, 0], half[:, 1], *_cosines(light, view), lx * vx - ly * vy, lx * vy + ly * vx,
            cos_difference, (lx * vy - ly * vx) ** 2,
        ],
        axis=1,
    )  # fmt: skip


def isotropic_exchange(light: Array, view: Array) -> Array:
    """Return `isotropic` and the difference of the cosines, which exchange turns round, (n, 6)."""
    return np.concatenate([isotropic(light, view), (light - view)[:, 2:]], axis=1)


def anisotropic_exchange(light: Array, view: Array) -> Array:
    """Return `anisotropic` and light - view, which exchange turns round, shape (n, 11)."""
    return np.concatenate([anisotropic(light, view), light - view], axis=1)


HALFWAY: dict[str, Inputs] = {
    "isotropic": isotropic,
    "isotropic-exchange": isotropic_exchange,
    "anisotropic": anisotropic,
    "anisotropic-exchange": anisotropic_exchange,
}
"""Each maps light and view, shapes (n, 3), to inputs; without `-exchange` they are reciprocal."""

HALFWAY_INPUTS = {
    "isotropic": 5,
    "isotropic-exchange": 6,
    "anisotropic": 8,
    "anisotropic-exchange": 11,
}
"""How many inputs each has."""


def _half(light: Array, view: Array) -> tuple[Array, Array]:
    """Return the half vector and its cosine to either direction; opposite ones have the normal."""
    total = light + view
    length = np.linalg.norm(total, axis=1, keepdims=True)
    half = np.where(length > 1e-9, total / np.maximum(length, 1e-9), (0.0, 0.0, 1.0))
    return half, length[:, 0] / 2


def _cosines(light: Array, view: Array) -> tuple[Array, Array]:
    cos_light, cos_view = light[:, 2].clip(0.0), view[:, 2].clip(0.0)
    return np.sqrt(cos_light * cos_view), cos_light + cos_view
