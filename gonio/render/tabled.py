"""A table for pictures: the same values as `gonio.materials.MeasuredTable`, twice as fast."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import normalize, paper_directions
from gonio.materials import MeasuredTable, SphericalMesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Material

    Array = NDArray[np.float64]
    Nodes = tuple[NDArray[np.int64], Array]

_CELLS, _TILE = 384, 16
_RIM_Z = np.cos(np.radians(75.0))
_OUTSIDE = -1e-9


def quick(material: Material) -> Material:
    """Return the same material in the form that pictures evaluate fastest."""
    if isinstance(material, MeasuredTable):
        return _Tabled(material.values.reshape(-1, 3))
    return material


@dataclass(frozen=True)
class _Tabled:
    """Values by pair of the grid, shape (6561, 3)."""

    values: Array

    def evaluate(self, light: Array, view: Array) -> Array:
        """Return the BRDF in 1/sr, shape (n, 3), of unit vectors of shape (n, 3)."""
        (light_node, light_weight), (view_node, view_weight) = _locate(light), _locate(view)
        result = np.zeros(light.shape)
        for i in range(3):
            row = light_node[:, i] * len(paper_directions())
            for j in range(3):
                weight = light_weight[:, i] * view_weight[:, j]
                result += weight[:, None] * self.values[row + view_node[:, j]]
        return result


def _locate(direction: Array) -> Nodes:
    """Return nodes and weights as `SphericalMesh.locate` does.

    The face at the middle of a direction's cell is mostly that of the direction; where it is not,
    by a weight below zero, the mesh itself is asked.
    """
    faces, inverse, face_of = _lookup()
    inside = _within_rim(direction)
    face = face_of[tuple(_cell(inside).T)]
    weight = np.einsum("nij,nj->ni", inverse[face], inside)
    node = faces[face]
    missed = np.flatnonzero(weight.min(axis=1) < _OUTSIDE)
    weight = weight.clip(0.0)
    weight /= weight.sum(axis=1, keepdims=True)
    node[missed], weight[missed] = _mesh().locate(inside[missed])
    return node, weight


def _within_rim(direction: Array) -> Array:
    """Return directions with theta clamped at 75 deg, shape (n, 3)."""
    level = np.hypot(direction[:, 0], direction[:, 1]).clip(1e-300)
    scale = np.minimum(1.0, np.sqrt(1.0 - _RIM_Z**2) / level)
    return np.stack(
        [direction[:, 0] * scale, direction[:, 1] * scale, np.maximum(direction[:, 2], _RIM_Z)], -1
    )


def _cell(direction: Array) -> NDArray[np.int64]:
    """Return the cell over the disc of equal areas, shape (n, 2)."""
    disc = direction[:, :2] / np.sqrt(1.0 + direction[:, 2:])
    return np.asarray(((disc + 1.0) / 2.0 * _CELLS).astype(np.int64))


@cache
def _mesh() -> SphericalMesh:
    return SphericalMesh(paper_directions())


@cache
def _lookup() -> tuple[NDArray[np.int64], Array, NDArray[np.int64]]:
    """Return the faces' nodes, the inverses of their corners, and the face of each cell."""
    steps = (np.arange(_CELLS) + 0.5) / _CELLS * 2.0 - 1.0
    x, y = (each.ravel() for each in np.meshgrid(steps, steps, indexing="ij"))
    square = np.minimum(x**2 + y**2, 1.0)
    stretch = np.sqrt(2.0 - square)
    middle = normalize(np.stack([x * stretch, y * stretch, 1.0 - square], axis=-1))
    nodes = np.empty(middle.shape, np.int64)
    near = _by_tiles()
    nodes[near], _ = _mesh().locate(_within_rim(middle[near]))
    nodes.sort(axis=1)
    count = len(paper_directions())
    # one number a face: numbers are sorted much faster than rows
    number = nodes @ np.array([count**2, count, 1])
    _, first, face_of = np.unique(number, return_index=True, return_inverse=True)
    faces = nodes[first]
    corners = np.swapaxes(paper_directions()[faces], 1, 2)
    inverse = np.asarray(np.linalg.inv(corners), np.float64)
    return faces, inverse, face_of.reshape(_CELLS, _CELLS).astype(np.int64)


def _by_tiles() -> NDArray[np.int64]:
    """Return the cells tile by tile: the mesh is quick where it is asked for near ones at once."""
    cells = np.arange(_CELLS**2).reshape(_CELLS // _TILE, _TILE, _CELLS // _TILE, _TILE)
    return cells.transpose(0, 2, 1, 3).ravel()
