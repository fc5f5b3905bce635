"""What all analytic models share: which directions count, and colors."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

Color = tuple[float, float, float]

# the cosine of 90 deg is 6e-17 in floating point, which is the horizon, not above it
_HORIZON = 1e-12


class AnalyticBrdf(ABC):
    """A BRDF by formula, zero for a direction at or below the horizon."""

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the BRDF in 1/sr, linear sRGB, shape (..., 3) (see `gonio.protocols.Material`)."""
        light, view = np.broadcast_arrays(
            np.asarray(light, np.float64), np.asarray(view, np.float64)
        )
        above = both_above(light, view)
        result = np.zeros(light.shape)
        if above.any():
            result[above] = self._above(light[above], view[above])
        return result

    @abstractmethod
    def _above(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the BRDF of directions above the horizon: shapes (n, 3) to (n, 3)."""


def both_above(light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return of which pairs both directions are above the horizon: shapes (..., 3) to (...)."""
    return np.asarray((light[..., 2] > _HORIZON) & (view[..., 2] > _HORIZON))


def turn(direction: NDArray[np.float64], phi: float) -> NDArray[np.float64]:
    """Return directions, shape (..., 3), as seen from a frame turned by `phi` about the normal."""
    if phi == 0.0:
        return direction
    cos, sin = np.cos(phi), np.sin(phi)
    turned: NDArray[np.float64] = direction @ [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]
    return turned


def dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the scalar products of vectors, shapes (n, 3) to (n,)."""
    return np.asarray(np.einsum("ni,ni->n", a, b))


def colored(shape: NDArray[np.float64], color: Color) -> NDArray[np.float64]:
    """Return values of shape (n,) in each channel of `color`, shape (n, 3)."""
    value: NDArray[np.float64] = shape[:, None] * np.asarray(color)
    return value


def schlick(cosine: NDArray[np.float64], f0: Color) -> NDArray[np.float64]:
    """Return Fresnel reflectance, shape (n, 3), for cosines of shape (n,) (Schlick 1994)."""
    normal = np.asarray(f0)
    grazing = np.clip(1.0 - cosine, 0.0, 1.0)[:, None] ** 5
    return normal + (1.0 - normal) * grazing
