"""Empirical lobes: powers of a cosine about the mirror direction or the half vector."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.analytic.base import dot, turn
from nnbrdf.fitting.diffuse import BODY_AND_LOBE, with_body
from nnbrdf.fitting.family import Family, Parameter

if TYPE_CHECKING:
    from nnbrdf.fitting.family import Floats, Pairs

EXPONENT = Parameter("n", "1", 1.0, 3000.0, spread_by_ratio=True)
PHI = Parameter("phi", "rad", 0.0, float(np.pi))
_STRAUSS_F, _STRAUSS_G, _STRAUSS_J = 1.12, 1.01, 0.1


def _phong(pairs: Pairs, shape: Floats) -> Floats:
    (n,) = shape
    lobe = (n + 2.0) / (2.0 * np.pi) * pairs.mirror_view**n
    return with_body(pairs, lobe)


def _blinn_phong(pairs: Pairs, shape: Floats) -> Floats:
    (n,) = shape
    scale = (n + 2.0) * (n + 4.0) / (8.0 * np.pi * (2.0 ** (-n / 2.0) + n))
    return with_body(pairs, scale * pairs.half_z**n)


def _lafortune(pairs: Pairs, shape: Floats) -> Floats:
    c_x, c_y, c_z, n, phi = shape
    light, view = turn(pairs.light, phi), turn(pairs.view, phi)
    cosine = dot(light * [c_x, c_y, c_z], view).clip(0.0)
    return with_body(pairs, (n + 2.0) / (2.0 * np.pi) * cosine**n)


def _strauss(pairs: Pairs, shape: Floats) -> Floats:
    smoothness, metalness = shape
    light_share, view_share = (
        np.arccos(cosine.clip(0.0, 1.0)) / (np.pi / 2.0) for cosine in (pairs.light_z, pairs.view_z)
    )
    body = 1.0 - smoothness**3
    normal = 1.0 - body
    fresnel = _strauss_fresnel(light_share)
    shadow = _strauss_shadow(light_share) * _strauss_shadow(view_share)
    strength = np.minimum(1.0, normal + (normal + _STRAUSS_J) * fresnel * shadow)
    lobe = strength * pairs.mirror_view ** (3.0 / (1.0 - smoothness)) / (np.pi * pairs.light_z)
    tinted = metalness * (1.0 - fresnel)
    diffuse = (1.0 - metalness * smoothness) * body / np.pi
    return np.stack([diffuse + tinted * lobe, (1.0 - tinted) * lobe], axis=1)


def _strauss_fresnel(x: Floats) -> Floats:
    """Return Strauss's F, 0 at normal and 1 at grazing incidence."""
    k = _STRAUSS_F
    return np.asarray(((x - k) ** -2 - k**-2) / ((1.0 - k) ** -2 - k**-2))


def _strauss_shadow(x: Floats) -> Floats:
    """Return Strauss's G, 1 at normal and 0 at grazing incidence."""
    k = _STRAUSS_G
    return np.asarray(((1.0 - k) ** -2 - (x - k) ** -2) / ((1.0 - k) ** -2 - k**-2))


PHONG = Family(
    "phong",
    "Phong (1975), normalized by Lewis (1994)",
    (EXPONENT,),
    BODY_AND_LOBE,
    _phong,
)
BLINN_PHONG = Family(
    "blinn-phong",
    "Blinn (1977), normalized by Giesen (2009)",
    (EXPONENT,),
    BODY_AND_LOBE,
    _blinn_phong,
)
LAFORTUNE = Family(
    "lafortune",
    "Lafortune et al. (1997), one generalized cosine lobe, equation 9",
    (
        Parameter("C_x", "1", -1.2, 1.2),
        Parameter("C_y", "1", -1.2, 1.2),
        Parameter("C_z", "1", 0.0, 1.2),
        EXPONENT,
        PHI,
    ),
    BODY_AND_LOBE,
    _lafortune,
    bounded=False,  # a lobe longer than 1 returns more than it gets
)
STRAUSS = Family(
    "strauss",
    "Strauss (1990), A realistic lighting model for computer animators, opaque",
    (Parameter("smoothness", "1", 0.0, 0.98), Parameter("metalness", "1", 0.0, 1.0)),
    ("surface", "highlight"),
    _strauss,
    reciprocal=False,
    bounded=False,  # the highlight is divided by the cosine of incidence
)
