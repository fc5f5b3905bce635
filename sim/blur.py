"""A picture that moves while the shutter is open."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_LEAST_PX = 1e-3
_MOST_PX = 100


def blurred_mosaic(
    mosaic: NDArray[np.float64], shifts_px: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the mean of a Bayer mosaic at several places: each color moves over its own pixels.

    Parameters
    ----------
    mosaic
        Shape (h, w).
    shifts_px
        As for `blurred`, in pixels of the mosaic.
    """
    moved = np.empty_like(mosaic)
    for row in (0, 1):
        for column in (0, 1):
            cell = np.s_[row::2, column::2]
            moved[cell] = blurred(mosaic[cell], 0.5 * shifts_px)
    return moved


def blurred(image: NDArray[np.float64], shifts_px: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean of a picture at several places; what comes in at its edge is as the edge.

    Parameters
    ----------
    image
        Shape (h, w).
    shifts_px
        Along rows' and columns' numbers, shape (n, 2), equal times apart.
    """
    from scipy.ndimage import convolve

    if np.abs(shifts_px).max() < _LEAST_PX:
        return image
    kernel = _kernel(np.clip(shifts_px, -_MOST_PX, _MOST_PX))
    return np.asarray(convolve(image, kernel, mode="nearest"), np.float64)


def _kernel(shifts_px: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the weights of whole shifts that stand for broken ones, linear in between; sum 1."""
    low = np.floor(shifts_px).astype(int)
    part = shifts_px - low
    reach = int(np.abs(low).max()) + 1
    kernel = np.zeros((2 * reach + 1, 2 * reach + 1))
    for row in (0, 1):
        for column in (0, 1):
            weights = np.abs(1 - row - part[:, 0]) * np.abs(1 - column - part[:, 1])
            np.add.at(kernel, (reach + low[:, 0] + row, reach + low[:, 1] + column), weights)
    return np.asarray(kernel / kernel.sum(), np.float64)
