"""Microfacet models: mirrors in all orientations that shadow each other."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.analytic.ggx import ggx_lobe
from nnbrdf.fitting.diffuse import BODY_AND_LOBE, with_body
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
    return _with_grooves(pairs, beckmann, f0)


def _torrance_sparrow(pairs: Pairs, shape: Floats) -> Floats:
    width, f0 = shape
    tilt = np.arccos(pairs.half_z.clip(-1.0, 1.0))
    gauss = np.exp(-((tilt / width) ** 2)) / (np.pi * width**2)
    return _with_grooves(pairs, gauss, f0)


def _with_grooves(pairs: Pairs, facets: Floats, f0: float) -> Floats:
    lobe = facets * _groove(pairs) / (4.0 * pairs.light_z * pairs.view_z)
    return with_body(pairs, lobe * schlick_term(pairs, f0))


def _ggx(pairs: Pairs, shape: Floats) -> Floats:
    alpha_x, alpha_y, f0, phi = shape
    return _with_ggx_lobes(pairs, f0, phi, (alpha_x, alpha_y))


def _ggx_two(pairs: Pairs, shape: Floats) -> Floats:
    alpha_x, alpha_y, second_x, second_y, f0, phi = shape
    return _with_ggx_lobes(pairs, f0, phi, (alpha_x, alpha_y), (second_x, second_y))


def _with_ggx_lobes(pairs: Pairs, f0: float, phi: float, *alphas: tuple[float, float]) -> Floats:
    turned, fresnel = pairs.turned(phi), schlick_term(pairs, f0)
    lobes = [ggx_lobe(turned.light, turned.view, turned.half, *each) * fresnel for each in alphas]
    return with_body(pairs, *lobes)


COOK_TORRANCE = Family(
    "cook-torrance",
    "Cook and Torrance (1982): Beckmann's facets, V-shaped grooves, normalized by 4",
    (replace(ALPHA_X, name="m"), F0),
    BODY_AND_LOBE,
    _cook_torrance,
)
TORRANCE_SPARROW = Family(
    "torrance-sparrow",
    "Torrance and Sparrow (1967): Gaussian facets, V-shaped grooves",
    (Parameter("width", "rad", 0.02, 1.0, spread_by_ratio=True), F0),
    BODY_AND_LOBE,
    _torrance_sparrow,  # bounded: its Gaussian's projected area is below 1, as sin cos < angle
)
GGX = Family(
    "ggx",
    "Walter et al. (2007), anisotropic by Heitz (2014), equations 85 and 99",
    (ALPHA_X, ALPHA_Y, F0, PHI),
    BODY_AND_LOBE,
    _ggx,
)
GGX_TWO_LOBES = Family(
    "ggx-two-lobes",
    "Walter et al. (2007) and Heitz (2014), two lobes of one grain, in either order",
    (
        ALPHA_X,
        ALPHA_Y,
        replace(ALPHA_X, name="second_alpha_x"),
        replace(ALPHA_Y, name="second_alpha_y"),
        F0,
        PHI,
    ),
    ("diffuse", "first", "second"),
    _ggx_two,
)
