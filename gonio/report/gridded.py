"""A model that is slow to evaluate, as its table on the 81 x 81 grid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.materials import MeasuredTable

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from gonio.protocols import Material

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class GriddedModel(MeasuredTable):
    """A table that knows how sure it is.

    Attributes
    ----------
    bands
        `sigma`, `lo` and `hi` as in `grid.npz`, shape (81, 81, 3) each.
    """

    bands: Mapping[str, NDArray[Any]]

    @classmethod
    def of_grid(cls, grid: Mapping[str, NDArray[Any]], white: float) -> GriddedModel:
        """Make it of what a model with that white, in 1/sr, says on the grid."""
        return cls(grid["values"].astype(np.float64), white, grid)

    def sigma(self, light: Array, view: Array) -> Array:
        """Return one standard uncertainty in 1/sr, shape (..., 3)."""
        return self._tables["sigma"].evaluate(light, view)

    def quantiles(self, light: Array, view: Array) -> tuple[Array, Array]:
        """Return the 5 and 95 % quantiles in 1/sr, shape (..., 3) each."""
        low, high = (self._tables[end].evaluate(light, view) for end in ("lo", "hi"))
        return low, high

    @cached_property
    def _tables(self) -> dict[str, MeasuredTable]:
        return {
            name: MeasuredTable(band.astype(np.float64), self.white)
            for name, band in self.bands.items()
        }


def quick_to_evaluate(material: Material) -> Material:
    """Return what a picture of half a million pairs may be made of in a second or two."""
    if is_slow(material):
        model: Any = material
        return GriddedModel.of_grid(model.grid(), model.card.white)
    return material


def is_slow(material: Material) -> bool:
    """Tell whether a material takes minutes for a picture; none is finer than its grid."""
    from nnbrdf.posterior_model import PosteriorBRDF

    return isinstance(material, PosteriorBRDF)
