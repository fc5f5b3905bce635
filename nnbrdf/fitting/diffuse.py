"""Diffuse models: bodies that scatter light to all sides."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.analytic.diffuse import fujii_term
from nnbrdf.fitting.family import Family, Parameter

if TYPE_CHECKING:
    from nnbrdf.fitting.family import Floats, Pairs

BODY_AND_LOBE = ("diffuse", "specular")


def with_body(pairs: Pairs, *lobes: Floats) -> Floats:
    """Return terms, shape (n, 1 + lobes): Lambert's 1 / pi, then lobes of shape (n,) each."""
    return np.stack([np.full(len(pairs.light), 1.0 / np.pi), *lobes], axis=1)


def _lambert(pairs: Pairs, shape: Floats) -> Floats:
    return with_body(pairs)


def _minnaert(pairs: Pairs, shape: Floats) -> Floats:
    (k,) = shape
    value = (k + 1.0) / (2.0 * np.pi) * (pairs.light_z * pairs.view_z) ** (k - 1.0)
    return np.asarray(value)[:, None]


def _oren_nayar(pairs: Pairs, shape: Floats) -> Floats:
    (sigma,) = shape
    return fujii_term(pairs.light, pairs.view, float(sigma))[:, None] / np.pi


LAMBERT = Family("lambert", "Lambert (1760), Photometria", (), ("diffuse",), _lambert)
MINNAERT = Family(
    "minnaert",
    "Minnaert (1941), The reciprocity principle in lunar photometry",
    (Parameter("k", "1", 0.5, 3.0),),
    ("diffuse",),
    _minnaert,
    bounded=False,  # for k < 1 it grows without limit at grazing angles
)
OREN_NAYAR = Family(
    "oren-nayar",
    "Oren and Nayar (1994) in the form of Fujii (2012), whose albedo is bounded",
    (Parameter("sigma", "1", 0.0, 1.0),),
    ("diffuse",),
    _oren_nayar,
)
