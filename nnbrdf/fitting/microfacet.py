"""Microfacet models: mirrors in all orientations that shadow each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.fitting.diffuse import lambert_term
from nnbrdf.fitting.family import Family, Parameter
from nnbrdf.fitting.gaussian import ALPHA_X, ALPHA_Y, F0, schlick_term
from nnbrdf.fitting.lobes import PHI

if TYPE_CHECKING:
    from nnbrdf.fitting.family import Floats, Pairs


def _groove(pairs: Pairs) -> Floats:
    """Return the masking of long V-shaped grooves (Torrance and Sparrow 1967)."""
    least = np.minimum(pairs.light_z, pairs.view_z)
    return np.asarray(
        np.minimum(1.0, 2.0 * pairs.half_z * least / np.maximum(pairs.light_half, 1e-12))
    )


def _cook_torrance(pairs: Pairs, shape: Floats) -> Floats:
    m, f0 = shape
    square = pairs.half_z**2
    beckmann = np.exp((square - 1.0) / (square * m**2)) / (np.pi * m**2 * square**2)
    lobe = beckmann * _groove(pairs) / (4.0 * pairs.light_z * pairs.view_z)
    return np.stack([lambert_term(pairs), lobe * schlick_term(pairs, f0)], axis=1)


def _torrance_sparrow(pairs: Pairs, shape: Floats) -> Floats:
    width, f0 = shape
    tilt = np.arccos(pairs.half_z.clip(-1.0, 1.0))
    gauss = np.exp(-((tilt / width) ** 2)) / (np.pi * width**2)
    lobe = gauss * _groove(pairs) / (4.0 * pairs.light_z * pairs.view_z)
    return np.stack([lambert_term(pairs), lobe * schlick_term(pairs, f0)], axis=1)


def ggx_lobe(pairs: Pairs, alpha_x: float, alpha_y: float) -> Floats:
    """Return D G / (4 cos cos), shape (n,): Walter et al. (2007), Heitz (2014), eqs 85 and 99."""
    stretch = np.array([alpha_x, alpha_y, 1.0])
    slope = np.square(pairs.half / stretch).sum(axis=1)
    light = np.linalg.norm(pairs.light * stretch, axis=1)
    view = np.linalg.norm(pairs.view * stretch, axis=1)
    # written so that nothing is divided by one small cosine
    visible = 0.5 / (pairs.light_z * view + pairs.view_z * light)
    return np.asarray(visible / (np.pi * alpha_x * alpha_y * slope**2))


def _ggx(pairs: Pairs, shape: Floats) -> Floats:
    alpha_x, alpha_y, f0, phi = shape
    lobe = ggx_lobe(pairs.turned(phi), alpha_x, alpha_y) * schlick_term(pairs, f0)
    return np.stack([lambert_term(pairs), lobe], axis=1)


def _ggx_two(pairs: Pairs, shape: Floats) -> Floats:
    alpha_x, alpha_y, other_x, other_y, f0, phi = shape
    turned, fresnel = pairs.turned(phi), schlick_term(pairs, f0)
    lobes = [
        ggx_lobe(turned, *alphas) * fresnel for alphas in ((alpha_x, alpha_y), (other_x, other_y))
    ]
    return np.stack([lambert_term(pairs), *lobes], axis=1)


COOK_TORRANCE = Family(
    "cook-torrance",
    "Cook and Torrance (1982): Beckmann's facets, V-shaped grooves, normalized by 4",
    (Parameter("m", "1", 0.02, 1.0, spread_by_ratio=True), F0),
    ("diffuse", "specular"),
    _cook_torrance,
)
TORRANCE_SPARROW = Family(
    "torrance-sparrow",
    "Torrance and Sparrow (1967): Gaussian facets, V-shaped grooves",
    (Parameter("width", "rad", 0.02, 1.0, spread_by_ratio=True), F0),
    ("diffuse", "specular"),
    _torrance_sparrow,
    bounded=False,  # its Gaussian is not normalized over the hemisphere
)
GGX = Family(
    "ggx",
    "Walter et al. (2007), anisotropic by Heitz (2014), equations 85 and 99",
    (ALPHA_X, ALPHA_Y, F0, PHI),
    ("diffuse", "specular"),
    _ggx,
)
GGX_TWO_LOBES = Family(
    "ggx-two-lobes",
    "Walter et al. (2007) and Heitz (2014), a sharp and a wide lobe of one grain",
    (
        ALPHA_X,
        ALPHA_Y,
        Parameter("wide_alpha_x", "1", 0.02, 1.0, spread_by_ratio=True),
        Parameter("wide_alpha_y", "1", 0.02, 1.0, spread_by_ratio=True),
        F0,
        PHI,
    ),
    ("diffuse", "sharp", "wide"),
    _ggx_two,
)
