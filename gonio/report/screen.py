"""How values of a color space are shown on a screen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gonio.color import srgb_from

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Screen(NamedTuple):
    """From a space to a screen's linear sRGB.

    Attributes
    ----------
    matrix
        Shape (3, 3).
    words
        What is shown.
    """

    matrix: NDArray[np.float64]
    words: str

    @classmethod
    def of(cls, color_space: str) -> Screen:
        """Make it of a space as files state it; what is of no known look is shown as it is."""
        matrix = srgb_from(color_space)
        if matrix is None:
            return cls(np.eye(3), f"{color_space} as if it were sRGB")
        return cls(matrix, "sRGB")

    def shown(self, values: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return values of the space in linear sRGB, shape (..., 3)."""
        return np.asarray(values @ self.matrix.T)
