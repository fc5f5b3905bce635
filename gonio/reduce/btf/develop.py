"""From the camera's channels to BRDF and sigma, in the squares that the array is stored in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.photogrammetry.rectification import Rectified, Rectifier

_MOST = float(np.finfo(np.float16).max)


@dataclass(frozen=True)
class Development:
    """What is done to each texel.

    Attributes
    ----------
    rate
        What each channel is multiplied by, shape (3,).
    relative
        Variance of the reference over its square, shape (3,).
    matrix
        From camera RGB to the colors of the array, shape (3, 3).
    even
        Irradiance at the sample's centre over that at each texel, shape (side, side).
    """

    rate: NDArray[np.float64]
    relative: NDArray[np.float64]
    matrix: NDArray[np.float64]
    even: NDArray[np.float32]


@dataclass(frozen=True)
class Tiles:
    """A picture in squares, as `gonio.reduce.btf.shard` writes it; NaN beyond the grid.

    Attributes
    ----------
    value
        BRDF, float32, shape (down, across, tile, tile, 3).
    sigma
        One standard uncertainty, float16, the same shape; infinite for a lower bound.
    """

    value: NDArray[np.float32]
    sigma: NDArray[np.float16]

    @classmethod
    def empty(cls, side: int, tile: int) -> Tiles:
        """Make room for a grid."""
        number = -(-side // tile)
        shape = (number, number, tile, tile, 3)
        return cls(np.full(shape, np.nan, np.float32), np.full(shape, np.nan, np.float16))


def develop(texels: Rectifier, by: Development, tiles: Tiles) -> None:
    """Rectify a picture and put BRDF and sigma of each texel into tiles.

    Where a channel was saturated in every exposure, these channels are cut to the lowest of their
    bounds, so that a white highlight stays white, and sigma is infinite.
    """
    if texels.compiled is not None:
        texels.compiled.develop(
            by.rate.tolist(), by.relative.tolist(), by.matrix.ravel().tolist(), by.even,
            tiles.value, tiles.sigma.view(np.uint16),
        )  # fmt: skip
        return
    side, tile = texels.grid.side, tiles.value.shape[2]
    for number, first in enumerate(range(0, side, tile)):
        last = min(first + tile, side)
        value, sigma = _developed(texels.rows(first, last), by, by.even[first:last])
        _put(tiles.value[number], value)
        _put(tiles.sigma[number], sigma)


def _developed(
    rectified: Rectified, by: Development, even: NDArray[np.float32]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return value and sigma of rows, shape (3, rows, side) each."""
    scale = by.rate[:, None, None] * even
    camera, clipped = rectified.value * scale, np.isinf(rectified.variance)
    lowest = np.min(camera, axis=0, where=clipped, initial=np.inf)
    camera = np.where(clipped, lowest, camera)
    variance = np.where(clipped, 0.0, rectified.variance * scale**2)
    variance += camera**2 * by.relative[:, None, None]
    value = np.einsum("ij,jkl->ikl", by.matrix, camera)
    sigma = np.sqrt(np.einsum("ij,jkl->ikl", by.matrix**2, variance))
    return value, np.where(clipped.any(axis=0) | (sigma > _MOST), np.inf, sigma)


def _put(tiles: NDArray[Any], rows: NDArray[np.float64]) -> None:
    """Put rows, shape (3, rows, side), into a row of tiles."""
    tile = tiles.shape[1]
    for tile_of, first in zip(tiles, range(0, rows.shape[2], tile), strict=True):
        part = rows[:, :, first : first + tile]
        tile_of[: part.shape[1], : part.shape[2]] = np.moveaxis(part, 0, -1)
