"""Mirror facets: the highlight of metals, coats and polished surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import half_vector
from nnbrdf.analytic.base import AnalyticBrdf, Color, dot, schlick, turn

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class AnisotropicGGX(AnalyticBrdf):
    """Facets of the GGX distribution, rougher along one tangent than along the other.

    D F G / (4 cos(theta_l) cos(theta_v)) with the distribution of Walter et al. (2007), its
    anisotropic form and Smith's height-correlated masking from Heitz (2014, equations 85 and 99),
    and Schlick's Fresnel term.

    Attributes
    ----------
    f0
        Reflectance at normal incidence.
    alpha_x, alpha_y
        Roughness along the tangent and across it; grooves along x make alpha_y the larger.
    phi
        Azimuth of the tangent, from +x, in radians.
    """

    f0: Color
    alpha_x: float
    alpha_y: float
    phi: float = 0.0

    def _above(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        light, view = turn(light, self.phi), turn(view, self.phi)
        half = half_vector(light, view)
        shape = ggx_lobe(light, view, half, self.alpha_x, self.alpha_y)
        return shape[:, None] * schlick(dot(half, light), self.f0)


def ggx_lobe(
    light: NDArray[np.float64],
    view: NDArray[np.float64],
    half: NDArray[np.float64],
    alpha_x: float,
    alpha_y: float,
) -> NDArray[np.float64]:
    """Return D G / (4 cos cos) in 1/sr, shapes (n, 3) to (n,), for a tangent along +x."""
    slope = np.square(half / [alpha_x, alpha_y, 1.0]).sum(axis=1)
    density = 1.0 / (np.pi * alpha_x * alpha_y * slope**2)
    stretch = [alpha_x, alpha_y, 1.0]
    light_length = np.linalg.norm(light * stretch, axis=1)
    view_length = np.linalg.norm(view * stretch, axis=1)
    # G / (4 cos cos), written so that nothing is divided by one small cosine
    visible = 0.5 / (light[:, 2] * view_length + view[:, 2] * light_length)
    lobe: NDArray[np.float64] = density * visible
    return lobe
