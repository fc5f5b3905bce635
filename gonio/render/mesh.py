"""A relief as triangles, whose texture coordinates carry the marked edge.

A renderer takes a triangle's tangent from how its texture coordinates grow, the same all over it.
So each triangle has corners of its own, with coordinates in its own frame.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.directions import normalize
from gonio.render.shapes import frames

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.render.shapes import Relief

    Array = NDArray[np.float64]

_SIDE = 257


class Mesh(NamedTuple):
    """Triangles in the picture's frame.

    Attributes
    ----------
    corner
        Shape (triangles, 3, 3).
    normal
        Of the surface at each corner, unit vectors, shape (triangles, 3, 3).
    texture
        Grows at each corner along tangent and bitangent, shape (triangles, 3, 2).
    """

    corner: Array
    normal: Array
    texture: Array


def mesh_of(relief: Relief) -> Mesh:
    """Return two triangles for each of 256 x 256 cells of a relief's square."""
    steps = np.linspace(-1.0, 1.0, _SIDE)
    x, y = (each.ravel() for each in np.meshgrid(steps, steps))
    node = np.stack([x, y, relief.height(x, y)], axis=-1)
    triangle = _triangles()
    corner = node[triangle]
    side = corner - corner[:, :1]
    # corners go round against the clock, so that this points up
    flat = normalize(np.cross(side[:, 1], side[:, 2]))
    frame = frames(flat, np.array([1.0, 0.0, 0.0]))
    texture = side @ np.swapaxes(frame[:, :2], 1, 2)
    shift = np.array([*relief.shift, 0.0])
    return Mesh(
        corner @ relief.axes * relief.scale + shift,
        relief.normal(node)[triangle] @ relief.axes,
        texture,
    )


def _triangles() -> NDArray[np.int64]:
    """Return the nodes of each triangle, shape (triangles, 3)."""
    node = np.arange(_SIDE**2).reshape(_SIDE, _SIDE)
    a, b, c, d = (
        each.ravel() for each in (node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1])
    )
    return np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])
