"""Materials made of materials: sums and turns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.analytic.base import turn

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Material


@dataclass(frozen=True)
class Sum:
    """Components that add up.

    Attributes
    ----------
    parts
        One material or more.
    """

    parts: tuple[Material, ...]

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the sum of the parts' BRDFs in 1/sr, shape (..., 3)."""
        first, *others = self.parts
        total = first.evaluate(light, view)
        for part in others:
            total = total + part.evaluate(light, view)
        return total


@dataclass(frozen=True)
class Rotated:
    """A material turned on the sample holder.

    Attributes
    ----------
    material
        What is turned.
    phi
        By how much, from +x towards +y, in radians.
    """

    material: Material
    phi: float

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the BRDF in 1/sr, shape (..., 3)."""
        return self.material.evaluate(
            turn(np.asarray(light, np.float64), self.phi),
            turn(np.asarray(view, np.float64), self.phi),
        )
