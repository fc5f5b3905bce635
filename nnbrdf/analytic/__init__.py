"""Reflectance by formula, each model with its source; all of them reciprocal."""

from nnbrdf.analytic.base import AnalyticBrdf, Color
from nnbrdf.analytic.compose import Rotated, Sum
from nnbrdf.analytic.diffuse import CoatedDiffuse, Lambert, OrenNayar
from nnbrdf.analytic.fibers import Fibers, Sheen
from nnbrdf.analytic.ggx import AnisotropicGGX

__all__ = [
    "AnalyticBrdf",
    "AnisotropicGGX",
    "CoatedDiffuse",
    "Color",
    "Fibers",
    "Lambert",
    "OrenNayar",
    "Rotated",
    "Sheen",
    "Sum",
]
