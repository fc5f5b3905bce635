"""Bodies that scatter light in all directions: even, rough, and under a glossy coat."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.analytic.base import AnalyticBrdf, Color, colored, dot

if TYPE_CHECKING:
    from numpy.typing import NDArray

COAT_SCALE = 28.0 / (23.0 * np.pi)
"""Makes `passed_by_coat` of the light and of the view a BRDF in 1/sr."""


@dataclass(frozen=True)
class Lambert(AnalyticBrdf):
    """The perfect diffuser: color / pi (Lambert 1760).

    Attributes
    ----------
    color
        Reflectance.
    """

    color: Color

    def _above(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.broadcast_to(np.asarray(self.color) / np.pi, light.shape)


@dataclass(frozen=True)
class OrenNayar(AnalyticBrdf):
    """Matte facets that shadow and light each other (Oren and Nayar 1994).

    In the form of Fujii (2012): color / pi x (1 + sigma s / t) / (1 + (1/2 - 2/(3 pi)) sigma), with
    s = light . view - cos(theta_l) cos(theta_v), and t the larger cosine where s > 0, else 1. The
    divisor keeps the albedo at or below `color` from every side, which the form of 1994 does not.

    Attributes
    ----------
    color
        Reflectance.
    sigma
        Roughness, 0 (Lambert) to 1.
    """

    color: Color
    sigma: float

    def _above(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        return colored(fujii_term(light, view, self.sigma), self.color) / np.pi


def fujii_term(
    light: NDArray[np.float64], view: NDArray[np.float64], sigma: float
) -> NDArray[np.float64]:
    """Return how much brighter than Lambert's `OrenNayar` is, shapes (n, 3) to (n,)."""
    light_z, view_z = light[:, 2], view[:, 2]
    s = dot(light, view) - light_z * view_z
    t = np.where(s > 0, np.maximum(light_z, view_z), 1.0)
    scale = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * np.pi)) * sigma)
    shape: NDArray[np.float64] = scale * (1.0 + sigma * s / t)
    return shape


@dataclass(frozen=True)
class CoatedDiffuse(AnalyticBrdf):
    """A diffuse body under a smooth coat, whose reflection it lacks (Ashikhmin and Shirley 2000).

    Their equation 5: 28 color / (23 pi) x (1 - f0) x (1 - (1 - cos(theta_l) / 2)^5) x the same of
    the view. The coat's own reflection is another component.

    Attributes
    ----------
    color
        Reflectance of the body.
    f0
        Reflectance of the coat at normal incidence.
    """

    color: Color
    f0: float

    def _above(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        passed = passed_by_coat(light[:, 2]) * passed_by_coat(view[:, 2])
        scale = COAT_SCALE * (1.0 - self.f0)
        return colored(scale * passed, self.color)


def passed_by_coat(cosine: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the share that a smooth coat lets through from a direction, shape (n,)."""
    passed: NDArray[np.float64] = 1.0 - (1.0 - cosine / 2.0) ** 5
    return passed
