"""A reflectance model with its parameters left open: colored terms of one common shape."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.analytic.base import AnalyticBrdf, dot, turn

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from gonio.protocols import Material

    Floats = NDArray[np.float64]
    Terms = Callable[["Pairs", Floats], Floats]


@dataclass(frozen=True)
class Parameter:
    """One number of a model's shape.

    Attributes
    ----------
    name, unit
        As a table names them; a unit of `1` is none.
    low, high
        Bounds, both possible.
    spread_by_ratio
        Whether halving it matters as much as doubling it.
    """

    name: str
    unit: str
    low: float
    high: float
    spread_by_ratio: bool = False

    def at(self, place: float) -> float:
        """Return the value at a place from 0, the lower bound, to 1, the upper."""
        if self.spread_by_ratio:
            return float(self.low * (self.high / self.low) ** place)
        return float(self.low + (self.high - self.low) * place)


@dataclass(frozen=True)
class Pairs:
    """Directions above the horizon and what all models need of them.

    Attributes
    ----------
    light, view
        Unit vectors, shape (n, 3).
    half
        The unit vector between them.
    """

    light: Floats
    view: Floats
    half: Floats

    @classmethod
    def of(cls, light: Floats, view: Floats) -> Pairs:
        """Make pairs of unit vectors, shape (n, 3) each, none of them opposite."""
        total = light + view
        return cls(light, view, total / np.linalg.norm(total, axis=1, keepdims=True))

    def chosen(self, places: NDArray[np.int64]) -> Pairs:
        """Return those at some places."""
        return Pairs(self.light[places], self.view[places], self.half[places])

    def turned(self, phi: float) -> Pairs:
        """Return them as seen from a frame turned by `phi` about the normal."""
        return Pairs(turn(self.light, phi), turn(self.view, phi), turn(self.half, phi))

    @property
    def light_z(self) -> Floats:
        """Cosine of incidence."""
        return self.light[:, 2]

    @property
    def view_z(self) -> Floats:
        """Cosine of the viewing angle."""
        return self.view[:, 2]

    @property
    def half_z(self) -> Floats:
        """Cosine of the half vector's polar angle."""
        return self.half[:, 2]

    @property
    def light_half(self) -> Floats:
        """Cosine of the difference angle, above 0, up to 1.

        As half the length of light + view: as a scalar product with the half vector it cancels
        down to 0 where both graze from opposite sides, and models divide by it.
        """
        return np.asarray(np.linalg.norm(self.light + self.view, axis=1) / 2.0).clip(None, 1.0)

    @property
    def mirror_view(self) -> Floats:
        """Cosine between the view and the mirrored light, 0 where it is negative."""
        mirrored = self.light * [-1.0, -1.0, 1.0]
        return dot(mirrored, self.view).clip(0.0, 1.0)


@dataclass(frozen=True)
class Family:
    """A model: f = sum over terms of color x term(shape).

    Attributes
    ----------
    name
        What the registry calls it.
    source
        Where its formula is from.
    shape
        Parameters that all colors share.
    terms
        Names of the terms; each has a color of its own.
    evaluate
        From pairs and shape values to terms, shape (n, terms), for a color of 1, in 1/sr.
    reciprocal
        Whether light and view may be swapped.
    bounded
        Whether no term alone, of color 1, returns more light than it gets, from any side.
    """

    name: str
    source: str
    shape: tuple[Parameter, ...]
    terms: tuple[str, ...]
    evaluate: Terms
    reciprocal: bool = True
    bounded: bool = True

    def material(self, shape: Floats, colors: Floats) -> Material:
        """Return the model with its parameters set.

        Parameters
        ----------
        shape
            Shape (parameters,).
        colors
            Shape (terms, 3).
        """
        return FamilyMaterial(self, tuple(float(value) for value in shape), colors)


@dataclass(frozen=True)
class FamilyMaterial(AnalyticBrdf):
    """A model with its parameters set.

    Attributes
    ----------
    family
        Which model.
    shape
        Values of its parameters.
    colors
        Shape (terms, 3).
    """

    family: Family
    shape: tuple[float, ...]
    colors: Floats

    def _above(self, light: Floats, view: Floats) -> Floats:
        terms = self.family.evaluate(Pairs.of(light, view), np.array(self.shape))
        return np.asarray(terms @ self.colors)
