"""Numbers as a scene file may hold them, and directions told by compass and horizon.

The world has x to the east, y to the north and z up. A bearing runs clockwise from north, an
elevation rises from the horizon.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import AfterValidator, BeforeValidator

from gonio.validation import within

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

Weight = Annotated[float, within(0, 1e30)]
Turn = Annotated[float, within(-360, 360)]
Place = Annotated[float, within(-1e6, 1e6)]
Point = tuple[Place, Place, Place]
_Length = Annotated[float, within(0, 1e6)]
Size = tuple[_Length, _Length]


def _both_ends(value: Any) -> Any:
    return (value, value) if isinstance(value, int | float) else value


def _in_order(span: tuple[float, float]) -> tuple[float, float]:
    if span[0] > span[1]:
        raise ValueError(f"[{span[0]:g}, {span[1]:g}] is the wrong way round; give [from, to]")
    return span


_span = (BeforeValidator(_both_ends), AfterValidator(_in_order))
_Day = Annotated[float, within(1, 366)]
_Hour = Annotated[float, within(0, 24)]
Heights = Annotated[tuple[Place, Place], *_span]
Distances = Annotated[tuple[_Length, _Length], *_span]
Days = Annotated[tuple[_Day, _Day], *_span]
Hours = Annotated[tuple[_Hour, _Hour], *_span]
"""A number, or [from, to], of which any is as likely."""


def between(span: tuple[float, float], share: Array) -> Array:
    """Return numbers at shares from 0 to 1 of a span."""
    return np.asarray(span[0] + (span[1] - span[0]) * share)


def toward(elevation: ArrayLike, bearing: ArrayLike) -> Array:
    """Return unit vectors in the world, shape (..., 3), for angles in radians."""
    elevation, bearing = np.broadcast_arrays(elevation, bearing)
    level = np.cos(elevation)
    parts = [level * np.sin(bearing), level * np.cos(bearing), np.sin(elevation)]
    return np.stack(parts, axis=-1)


def rotate(vector: Array, axis: Array, angle: ArrayLike) -> Array:
    """Turn vectors about unit axes, shapes (..., 3), by angles (...) (Rodrigues)."""
    cos, sin = np.cos(angle)[..., None], np.sin(angle)[..., None]
    along = np.sum(axis * vector, axis=-1, keepdims=True) * axis
    return np.asarray(cos * vector + sin * np.cross(axis, vector) + (1 - cos) * along)


def within_cone(middle: Array, half_angle: float, first: Array, second: Array) -> Array:
    """Return directions evenly spread over the cone about a unit vector (3,), shape (n, 3).

    `first` and `second` are n numbers each from 0 to 1, `half_angle` is in radians.
    """
    # the versine keeps the digits of a cone of a hundredth of a degree, which the cosine loses
    versine = 2 * np.sin(half_angle / 2) ** 2 * first
    sine = np.sqrt(versine * (2 - versine))
    right, up = across(middle)
    turn = 2 * np.pi * second[:, None]
    ring = np.cos(turn) * right + np.sin(turn) * up
    return np.asarray((1 - versine)[:, None] * middle + sine[:, None] * ring)


def across(middle: Array) -> tuple[Array, Array]:
    """Return two unit vectors at right angles to one, shape (3,), and to each other."""
    other = np.eye(3)[int(np.argmin(np.abs(middle)))]
    right = np.cross(other, middle)
    right /= np.linalg.norm(right)
    return right, np.cross(middle, right)
