"""What each pixel counts for in each texel, as a sparse matrix: where there is no kernel."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_matrix

    from gonio.photogrammetry.rectification import Rectifier

_REACH = np.arange(-1, 3)


def means_of_rows(
    of: Rectifier, first: int, last: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return texels and their variances, shape (3, rows, side) each, as `Rectifier` says."""
    grid, (across, down) = of.grid, of.parts
    x, y = grid.middles_mm(across), -grid.middles_mm(down)[first * down : last * down]
    columns, lines = of.camera.plane_pixels(x, y, of.pose)
    height, width = of.value.shape
    seen = (columns >= 1) & (columns < width - 2) & (lines >= 1) & (lines < height - 2)
    shape = (3, last - first, grid.side)
    value, variance = np.full(shape, np.nan, np.float32), np.full(shape, np.nan, np.float32)
    if not seen.any():
        return value, variance
    texel = (np.arange(len(y)) // down)[:, None] * grid.side + np.arange(len(x)) // across
    top, bottom = int(lines[seen].min()) - 1, int(lines[seen].max()) + 3
    weights = _weights(
        texel[seen], columns[seen], lines[seen] - top, (shape[1] * grid.side, bottom - top, width)
    )
    hidden = np.zeros(shape[1] * grid.side, bool)
    hidden[texel[~seen]] = True
    band = slice(top, bottom)
    rows, places = np.ogrid[band, :width]
    channel = np.array(of.channels)[2 * (rows % 2) + places % 2]
    for k in range(3):
        told = _mean(weights, of.value[band], of.variance[band], channel == k)
        for target, flat in zip((value, variance), told, strict=True):
            target[k] = np.where(hidden, np.nan, flat).reshape(shape[1:])
    return value, variance


def _weights(
    texel: NDArray[np.intp],
    columns: NDArray[np.float64],
    lines: NDArray[np.float64],
    shape: tuple[int, int, int],
) -> csr_matrix:
    """Return the sum of tents, two pixels to each side, over a texel's looks, (texels, pixels)."""
    from scipy.sparse import coo_matrix

    texels, height, width = shape
    (left, across), (top, down) = _tents(columns), _tents(lines)
    pixel = (top[:, :, None] * width + left[:, None, :]).reshape(len(texel), -1)
    weight = (down[:, :, None] * across[:, None, :]).reshape(len(texel), -1)
    where = (np.repeat(texel, pixel.shape[1]), pixel.ravel())
    return coo_matrix((weight.ravel(), where), (texels, height * width)).tocsr()


def _tents(place: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Return the four pixels about each place and their weights, shape (n, 4) each."""
    near = np.floor(place)[:, None] + _REACH
    return near.astype(np.intp), 1.0 - np.abs(near - place[:, None]) / 2.0


def _mean(
    weights: csr_matrix,
    value: NDArray[np.float32],
    variance: NDArray[np.float32],
    among: NDArray[np.bool_],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the mean of some pixels and its variance for each texel."""
    use = (among & ~np.isnan(value)).ravel()
    clipped = use & np.isinf(variance).ravel()
    total = weights @ use.astype(np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = weights @ np.where(use, value.ravel(), 0.0) / total
        spread = weights.power(2) @ np.where(use & ~clipped, variance.ravel(), 0.0) / total**2
    return mean, np.where(weights @ clipped.astype(np.float64) > 0, np.inf, spread)
