"""The unit disk on the unit square, areas kept.

Shirley and Chiu (1997), A low distortion map between disk and square, Journal of Graphics Tools
2(3), turned as Radiance's `disk2square.cal` has it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import TWO_PI

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_QUARTER = np.pi / 4


def square_from_disk(disk: Array) -> Array:
    """Return places in [0, 1]^2, shape (..., 2), of places in the unit disk."""
    x, y = disk[..., 0], disk[..., 1]
    radius = np.hypot(x, y)
    phi = (np.arctan2(y, x) + _QUARTER) % TWO_PI - _QUARTER
    region = np.floor((phi + _QUARTER) / (2 * _QUARTER)).astype(np.int64) % 4
    # within its quarter, from -1 to 1
    off = (phi - region * 2 * _QUARTER) / _QUARTER * radius
    a = np.choose(region, [radius, -off, -radius, off])
    b = np.choose(region, [off, radius, -off, -radius])
    return (np.stack([a, b], axis=-1).clip(-1.0, 1.0) + 1.0) / 2.0


def disk_from_square(square: Array) -> Array:
    """Return places in the unit disk, shape (..., 2), of places in [0, 1]^2."""
    a, b = np.moveaxis(2.0 * square - 1.0, -1, 0)
    wide = np.abs(a) > np.abs(b)
    radius = np.where(wide, a, b)
    ratio = np.where(wide, b, a) / np.where(radius == 0.0, 1.0, radius)
    phi = np.where(wide, _QUARTER * ratio, 2 * _QUARTER - _QUARTER * ratio)
    return np.stack([radius * np.cos(phi), radius * np.sin(phi)], axis=-1)
