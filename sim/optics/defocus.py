"""Defocus: what lies before or behind the focused distance is spread over a disc."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SHARP_PX: Final = 0.01
# between two layers of a disc's width the spread is mixed from both
_LAYER_PX: Final = 0.5
_MOST_LAYERS: Final = 4


def confusion_px(
    nearer_mm: NDArray[np.float64], *, distance_mm: float, aperture_mm: float, focal_px: float
) -> NDArray[np.float64]:
    """Return the diameter of the circle of confusion of a thin lens.

    A point at z is spread over A v |1 / s - 1 / z| behind an aperture A focused on s, where v is
    the distance of the image, so that v in pixels is the focal length of the projection (Potmesil
    and Chakravarty 1981).

    Parameters
    ----------
    nearer_mm
        By how much each pixel's point is nearer than the focused distance, shape (...).
    distance_mm
        s, on which the camera is focused.
    aperture_mm
        A, the focal length over the f-number.
    focal_px
        v in pixels.

    Returns
    -------
    ndarray
        In pixels, shape (...).
    """
    z_mm = distance_mm - nearer_mm
    diameter: NDArray[np.float64] = aperture_mm * focal_px * np.abs(1.0 / distance_mm - 1.0 / z_mm)
    return diameter


def defocus(image: NDArray[np.float64], diameter_px: NDArray[np.float64]) -> NDArray[np.float64]:
    """Spread each pixel's light over a disc of its own width; none of it is lost.

    Parameters
    ----------
    image
        Shape (height, width, 3).
    diameter_px
        Of each pixel's disc, shape (height, width).
    """
    widest = float(diameter_px.max())
    if widest < _SHARP_PX:
        return image
    steps = min(math.ceil(widest / _LAYER_PX), _MOST_LAYERS)
    place = diameter_px * (steps / widest)
    spread = image * np.clip(1.0 - place, 0.0, 1.0)[..., None]
    for layer in range(1, steps + 1):
        share = np.clip(1.0 - np.abs(place - layer), 0.0, 1.0)
        if share.any():
            kernel = disc(widest * layer / steps)
            near = _about(share > 0.0, len(kernel) // 2)
            spread[near] += _through(image[near] * share[near][..., None], kernel)
    return spread


@lru_cache(maxsize=64)
def disc(diameter_px: float) -> NDArray[np.float64]:
    """Return a disc's light on a grid of pixels about its middle, in all 1, shape (n, n), n odd."""
    radius = diameter_px / 2.0
    half = math.ceil(radius)
    points = max(15, 2 * half)
    # the same to the bit on both sides, as a mirror at the frame's edge needs it
    across = np.arange(-points, points + 1) / points
    x, y = np.meshgrid(across, across)
    inside = x * x + y * y <= 1.0
    kernel = np.zeros((2 * half + 1, 2 * half + 1))
    # each point falls on the four pixels about it, which moves no light on the whole
    column, right = np.divmod(radius * x[inside] + half, 1.0)
    row, low = np.divmod(radius * y[inside] + half, 1.0)
    for down, weight_y in ((0, 1.0 - low), (1, low)):
        for over, weight_x in ((0, 1.0 - right), (1, right)):
            weight = weight_x * weight_y
            # at the rim the pixel beyond has no weight, and perhaps no place
            rows = np.minimum(row.astype(int) + down, 2 * half)
            columns = np.minimum(column.astype(int) + over, 2 * half)
            np.add.at(kernel, (rows, columns), weight)
    kernel /= kernel.sum()
    return kernel


def _about(mask: NDArray[np.bool_], margin: int) -> tuple[slice, slice]:
    """Return the part of the frame that a mask and a margin about it take."""
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    top, left = max(rows[0] - margin, 0), max(columns[0] - margin, 0)
    return slice(top, rows[-1] + margin + 1), slice(left, columns[-1] + margin + 1)


def _through(image: NDArray[np.float64], kernel: NDArray[np.float64]) -> NDArray[np.float64]:
    """Spread an image by a symmetric kernel; what would leave the frame is mirrored into it."""
    # a part of the frame ends in a dark margin as wide as the kernel's half, which mirrors nothing
    import cv2

    return np.asarray(cv2.filter2D(image, -1, kernel, borderType=cv2.BORDER_REFLECT), np.float64)
