"""The grid of texels that all pictures of a sample are brought to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.errors import BadInputError
from gonio.geometry import SAMPLE_SIDE_MM

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import CameraSpec

_MM_PER_M = 1000.0
MOST_TEXELS: Final = 16384


@dataclass(frozen=True)
class TexelGrid:
    """Square texels on a square about the sample's centre; row 0 lies at +y, column 0 at -x.

    Attributes
    ----------
    side
        How many along each side.
    side_mm
        Of the square.

    Raises
    ------
    gonio.errors.BadInputError
        When `side` is not 1 to `MOST_TEXELS`.
    """

    side: int
    side_mm: float = SAMPLE_SIDE_MM

    def __post_init__(self) -> None:
        if not 1 <= self.side <= MOST_TEXELS:
            raise BadInputError(
                f"{self.side} texels a side are out of range; use 1 to {MOST_TEXELS}"
            )

    @classmethod
    def of_camera(cls, spec: CameraSpec) -> TexelGrid:
        """Return the grid over the sample whose texels are pixels seen from above."""
        return cls(round(SAMPLE_SIDE_MM * spec.focal_px / (_MM_PER_M * spec.distance_m)))

    @property
    def pitch_mm(self) -> float:
        """Side of a texel."""
        return self.side_mm / self.side

    @property
    def x_mm(self) -> NDArray[np.float64]:
        """Middle of each column, rising, shape (side,); of each row it is the negative."""
        return self.middles_mm(1)

    def middles_mm(self, parts: int) -> NDArray[np.float64]:
        """Return the middles of texels cut into parts, shape (side * parts,), along +x."""
        step = self.pitch_mm / parts
        return np.asarray((np.arange(self.side * parts) + 0.5) * step - self.side_mm / 2.0)
