"""Fibers: the highlights of wood grain and threads, and the bloom of a nap."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import half_vector
from nnbrdf.analytic.base import AnalyticBrdf, Color, colored, turn

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Fibers(AnalyticBrdf):
    """Parallel fibers under a smooth surface, each reflecting into a cone about its axis.

    The fiber term of Marschner et al. (2005, Measuring and Modeling the Appearance of Finished
    Wood, section 5): T(light) T(view) color g(psi_l + psi_v) / cos^2((psi_l - psi_v) / 2), where
    psi is a refracted direction's inclination to the plane across the fiber, g a normalised
    Gaussian and T what the surface lets through.

    Attributes
    ----------
    color
        Strength of the highlight, in rad/sr.
    width
        Standard deviation of the cone, in radians.
    tilt
        Elevation of the fibers' axis out of the surface, in radians.
    phi
        Azimuth of the fibers' axis, from +x, in radians.
    index
        Refractive index below the surface.
    """

    color: Color
    width: float
    tilt: float = 0.0
    phi: float = 0.0
    index: float = 1.5

    def _above(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        psi_light, psi_view = self._inclination(light), self._inclination(view)
        offset = (psi_light + psi_view) / self.width
        gauss = np.exp(-0.5 * offset**2) / (np.sqrt(2.0 * np.pi) * self.width)
        shape = gauss / np.cos((psi_light - psi_view) / 2.0) ** 2
        through = self._through(light[:, 2]) * self._through(view[:, 2])
        return colored(shape * through, self.color)

    def _inclination(self, direction: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y, _ = np.moveaxis(turn(direction, self.phi), -1, 0) / self.index
        z = np.sqrt(1.0 - x**2 - y**2)
        along = np.cos(self.tilt) * x + np.sin(self.tilt) * z
        return np.asarray(np.arcsin(np.clip(along, -1.0, 1.0)))

    def _through(self, cosine: NDArray[np.float64]) -> NDArray[np.float64]:
        f0 = ((self.index - 1.0) / (self.index + 1.0)) ** 2
        through: NDArray[np.float64] = (1.0 - f0) * (1.0 - (1.0 - cosine) ** 5)
        return through


@dataclass(frozen=True)
class Sheen(AnalyticBrdf):
    """Upright fibers that glow towards grazing angles: velvet's rim, the bloom of cloth.

    color x D / (4 (cos_l + cos_v - cos_l cos_v)) with the distribution of Estevez and Kulla (2017),
    D = (2 + 1/alpha) sin(theta_h)^(1/alpha) / (2 pi), and the denominator of Neubelt and Pettineo
    (2013).

    Attributes
    ----------
    color
        Strength.
    alpha
        Roughness, 0 to 1: the smaller, the closer to the rim.
    """

    color: Color
    alpha: float

    def _above(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        half = half_vector(light, view)
        sine = np.hypot(half[:, 0], half[:, 1])
        density = (2.0 + 1.0 / self.alpha) * sine ** (1.0 / self.alpha) / (2.0 * np.pi)
        light_z, view_z = light[:, 2], view[:, 2]
        shape = density / (4.0 * (light_z + view_z - light_z * view_z))
        return colored(shape, self.color)
