"""The models by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.errors import BadInputError
from nnbrdf.fitting import diffuse, gaussian, lobes, microfacet

if TYPE_CHECKING:
    from nnbrdf.fitting.family import Family

_ALL = (
    diffuse.LAMBERT, diffuse.MINNAERT, diffuse.OREN_NAYAR, lobes.PHONG, lobes.BLINN_PHONG,
    lobes.STRAUSS, microfacet.COOK_TORRANCE, lobes.LAFORTUNE, gaussian.SCHLICK, gaussian.WARD,
    gaussian.WARD_BOUNDED, gaussian.ASHIKHMIN_SHIRLEY, gaussian.EDWARDS,
    microfacet.TORRANCE_SPARROW, microfacet.GGX, microfacet.GGX_TWO_LOBES,
)  # fmt: skip
MODELS: dict[str, Family] = {family.name: family for family in _ALL}


def model_named(name: str) -> Family:
    """Return a model.

    Raises
    ------
    BadInputError
        For an unknown name, listing the known.
    """
    if name not in MODELS:
        raise BadInputError(f"model {name!r} is not known; use {', '.join(MODELS)}")
    return MODELS[name]
