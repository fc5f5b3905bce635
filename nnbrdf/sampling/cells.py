"""Piecewise constant densities over half vectors, drawn from by inverting tabulated sums."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import TWO_PI

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Index = NDArray[np.int64]

RINGS, SECTORS = 64, 48
# rings grow as theta^2, so that a lobe of a hundredth of a radian still spans several
_POWER = 4


@dataclass(frozen=True)
class Cells:
    """Several densities over the hemisphere of half vectors, each constant in every cell.

    A cell is a sector of a ring; rings crowd towards the normal.

    Attributes
    ----------
    mass
        Probability of each cell, shape (densities, RINGS, SECTORS), each density adding up to 1.
    """

    mass: Array

    def density(self, which: Index, half: Array) -> Array:
        """Return densities in 1/sr at unit vectors of shape (n, 3), shape (n,)."""
        depth = _depth(half)
        ring = (RINGS * depth ** (1 / _POWER)).astype(int).clip(0, RINGS - 1)
        turns = np.arctan2(half[:, 1], half[:, 0]) / TWO_PI % 1.0
        sector = (SECTORS * turns).astype(int).clip(0, SECTORS - 1)
        return np.where(half[:, 2] > 0, self._in_cell(which, ring, sector), 0.0)

    def draw(self, which: Index, u: Array) -> Array:
        """Return half vectors, shape (n, 3), for uniform numbers of shape (n, 2).

        The first number chooses the ring by the sum over sectors (marginal), the second the sector
        within it (conditional), each what is left of it the place in the cell.
        """
        ring, inner = _invert(self._rings, which, u[:, 0])
        sector, along = _invert(self._sectors, which * RINGS + ring, u[:, 1])
        depth = EDGES[ring] + inner * (EDGES[ring + 1] - EDGES[ring])
        return half_at(depth, TWO_PI * (sector + along) / SECTORS)

    def _in_cell(self, which: Index, ring: Index, sector: Index) -> Array:
        return np.asarray(self.mass[which, ring, sector] / AREA[ring])

    @cached_property
    def _rings(self) -> Array:
        return _sums(self.mass.sum(axis=2))

    @cached_property
    def _sectors(self) -> Array:
        return _sums(self.mass.reshape(-1, SECTORS))


EDGES: Array = (np.arange(RINGS + 1) / RINGS) ** _POWER
"""Where rings begin and the last one ends, in 1 - cos(theta), on which solid angle is uniform."""

AREA: Array = np.diff(EDGES) * TWO_PI / SECTORS
"""Solid angle of a cell of each ring, in sr."""


def half_at(depth: Array, phi: Array) -> Array:
    """Return unit vectors, shape (n, 3), for 1 - cos(theta) and azimuth."""
    sine = np.sqrt(depth * (2.0 - depth))
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), 1.0 - depth], axis=-1)


def _depth(half: Array) -> Array:
    """Return 1 - cos(theta) without the cancellation near the normal."""
    squared = half[:, 0] ** 2 + half[:, 1] ** 2
    return np.asarray((squared / (1.0 + half[:, 2].clip(0.0))).clip(0.0, 1.0))


def _sums(mass: Array) -> Array:
    """Return the running shares of each row, shape (rows, n), ending in exactly 1."""
    total = mass.cumsum(axis=1)
    last = total[:, -1:]
    even = np.arange(1, mass.shape[1] + 1) / mass.shape[1]
    return np.where(last > 0, total / np.where(last > 0, last, 1.0), even)


def _invert(sums: Array, row: Index, u: Array) -> tuple[Index, Array]:
    """Return the entry of its row in which each number falls, and how far in, 0 to 1."""
    count = sums.shape[1]
    # one sorted list of all rows, each moved by its number, makes one search of many
    moved = (sums + np.arange(len(sums))[:, None]).ravel()
    entry = np.searchsorted(moved, row + u, side="right") - row * count
    entry = entry.clip(0, count - 1)
    end = sums[row, entry]
    start = np.where(entry > 0, sums[row, entry - 1], 0.0)
    inner = (u - start) / np.where(end > start, end - start, 1.0)
    return entry, inner.clip(0.0, 1.0)
