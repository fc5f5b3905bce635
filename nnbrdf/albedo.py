"""Directional albedo: how much of the light from one direction a material gives back."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.directions import from_spherical

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Material

INCIDENCES_DEG = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)
_RINGS = 96


class Albedo(NamedTuple):
    """Directional albedo at one incidence.

    Attributes
    ----------
    incidence_deg
        Polar angle of the light.
    value
        Albedo of each channel, the mean over azimuths of the light for what has a grain.
    error
        How far a quadrature of half the nodes each way is from it, the largest of the channels.
    """

    incidence_deg: float
    value: tuple[float, float, float]
    error: float


def directional_albedo(material: Material, azimuths: int = 4) -> list[Albedo]:
    """Integrate BRDF times cosine over the views, at six incidences from 0 to 75 degrees.

    Gauss-Legendre nodes in the squared sine of the view's polar angle, on which cosine-weighted
    solid angle is uniform, times equally spaced azimuths. Above one, the model gives back more
    light than came: between samples, or since narrow lobes are sampled at single nodes.

    Parameters
    ----------
    material
        To be audited.
    azimuths
        Of the light, spread over half a turn.
    """
    light_phi = np.pi * np.arange(azimuths) / azimuths
    result = []
    for incidence_deg in INCIDENCES_DEG:
        lights = from_spherical(np.full(azimuths, np.radians(incidence_deg)), light_phi)
        fine, coarse = (
            np.mean([_integral(material, light, rings, 2 * rings) for light in lights], axis=0)
            for rings in (_RINGS, _RINGS // 2)
        )
        red, green, blue = fine.tolist()
        error = float(np.abs(fine - coarse).max())
        result.append(Albedo(incidence_deg, (red, green, blue), error))
    return result


def _integral(
    material: Material, light: NDArray[np.float64], rings: int, azimuths: int
) -> NDArray[np.float64]:
    node, weight = np.polynomial.legendre.leggauss(rings)
    theta = np.arcsin(np.sqrt(0.5 * (node + 1)))
    # an offset of half a step, so that no node lies in the plane of incidence of every light
    phi = 2 * np.pi * (np.arange(azimuths) + 0.5) / azimuths
    view = from_spherical(np.repeat(theta, azimuths), np.tile(phi, rings))
    values = material.evaluate(light, view).reshape(rings, azimuths, -1)
    # pi times the mean over the disk; the weights add up to 2
    return np.asarray(np.pi * 0.5 * np.einsum("r,rac->c", weight, values) / azimuths)
