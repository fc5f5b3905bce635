"""A 24-patch color chart that fits into the sample's place."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.chart import COLUMNS, PATCHES, ROWS, places, published_xyz
from gonio.color import XYZ_FROM_SRGB
from nnbrdf.analytic import Lambert

if TYPE_CHECKING:
    from numpy.typing import NDArray

PITCH_MM: Final = 11.0
PATCH_MM: Final = 9.0
_RIM_MM = 1.0
_FRAME = 0.03
# a pixel sees the mean of so many points along each of its sides
_POINTS = 3


class ColorChart:
    """Matte patches in a black frame, dark skin at -x and +y; the holder about it is black, too.

    Patches are what is published of charts (`gonio.chart.published_xyz`), so their colors are known
    under D65 alone; cyan is beyond sRGB, below zero in red.
    """

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the patches' mean as a material (see `gonio.protocols.Material`)."""
        red, green, blue = patches_srgb().mean(axis=0).tolist()
        return Lambert((red, green, blue)).evaluate(light, view)

    def seen(self, points_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the BRDF that each pixel sees, the mean over what lies in it.

        Parameters
        ----------
        points_mm
            Where the middle of each pixel looks, shape (height, width, 3).

        Returns
        -------
        ndarray
            Linear sRGB in 1/sr, shape (height, width, 3), 0 beyond the chart.
        """
        down, across = np.gradient(points_mm[..., :2], axis=(0, 1))
        steps = (np.arange(_POINTS) + 0.5) / _POINTS - 0.5
        total = np.zeros(points_mm.shape)
        for row in steps:
            for column in steps:
                total += _reflectance(points_mm[..., :2] + row * down + column * across)
        return total / (_POINTS**2 * np.pi)


def patches_srgb() -> NDArray[np.float64]:
    """Return the reflectance of the patches, linear sRGB, shape (24, 3)."""
    srgb: NDArray[np.float64] = published_xyz() @ np.linalg.inv(XYZ_FROM_SRGB).T
    return srgb


def centres_mm() -> NDArray[np.float64]:
    """Return where the patches' centres are in the sample's frame, z = 0, shape (24, 3)."""
    column, row = places().T
    x, y = column - (COLUMNS - 1) / 2.0, (ROWS - 1) / 2.0 - row
    return PITCH_MM * np.stack([x, y, np.zeros(PATCHES)], axis=-1)


def _reflectance(places_mm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the reflectance at places on the plane, shape (..., 2) to (..., 3)."""
    column = places_mm[..., 0] / PITCH_MM + COLUMNS / 2.0
    row = ROWS / 2.0 - places_mm[..., 1] / PITCH_MM
    rim = _RIM_MM / PITCH_MM
    framed = (column > -rim) & (column < COLUMNS + rim) & (row > -rim) & (row < ROWS + rim)
    off = np.maximum(np.abs(column % 1.0 - 0.5), np.abs(row % 1.0 - 0.5))
    on_patch = (column > 0) & (column < COLUMNS) & (row > 0) & (row < ROWS)
    on_patch &= off < 0.5 * PATCH_MM / PITCH_MM
    number = COLUMNS * np.floor(row).clip(0, ROWS - 1) + np.floor(column).clip(0, COLUMNS - 1)
    patches = patches_srgb()[number.astype(np.intp)]
    return np.where(on_patch[..., None], patches, np.where(framed, _FRAME, 0.0)[..., None])
