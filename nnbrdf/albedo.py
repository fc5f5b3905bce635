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
_CROWDED = 10.0


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

    Views are integrated over the unit disk of their projections, on which cosine-weighted solid
    angle is uniform, in polar coordinates about the mirrored direction: equally spaced azimuths,
    and Gauss-Legendre nodes in a coordinate that crowds towards it, as lobes do. Above one, the
    model gives back more light than came: between samples, or since narrow lobes are sampled at
    single nodes.

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
    # from 0 at the mirrored direction to 1 at the rim, and its slope
    share = np.sinh(_CROWDED * 0.5 * (node + 1)) / np.sinh(_CROWDED)
    slope = _CROWDED * np.cosh(_CROWDED * 0.5 * (node + 1)) / np.sinh(_CROWDED)
    phi = 2 * np.pi * np.arange(azimuths) / azimuths
    out = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    mirror = -light[:2]
    along = out @ mirror
    rim = np.sqrt(1 - mirror @ mirror + along**2) - along
    place = mirror + (share[:, None] * rim)[..., None] * out
    height = np.sqrt((1 - (place**2).sum(axis=-1, keepdims=True)).clip(0.0))
    view = np.concatenate([place, height], axis=-1)
    values = material.evaluate(light, view.reshape(-1, 3)).reshape(rings, azimuths, -1)
    # the weights add up to 2
    area = 0.5 * weight * slope * share * 2 * np.pi / azimuths
    return np.asarray(np.einsum("r,a,rac->c", area, rim**2, values))
