"""Where a relief hides itself from the light."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_SIDE, _AZIMUTHS = 96, 32
_FARTHEST, _STRIDES = 1.6, 24
# the sine of elevation over which a shadow's edge goes from dark to light
_SOFT = 0.06


class Around(NamedTuple):
    """The four nodes about each place, shape (n, 4), and their weights."""

    node: NDArray[np.int64]
    weight: Array


@dataclass(frozen=True)
class Horizon:
    """The sine of the elevation to which a relief is hidden, by place and azimuth.

    After Max (1988), Horizon mapping: shadows for bump-mapped surfaces.

    Attributes
    ----------
    sine
        Shape (azimuths, side x side).
    """

    sine: Array

    @staticmethod
    @lru_cache(maxsize=4)
    def of(height: Callable[[Array, Array], Array]) -> Horizon:
        """Look from each node of the square from -1 to 1 all around."""
        steps = np.linspace(-1.0, 1.0, _SIDE)
        x, y = np.meshgrid(steps, steps)
        ground = height(x, y)
        sine = np.zeros((_AZIMUTHS, _SIDE * _SIDE))
        for number in range(_AZIMUTHS):
            phi = 2.0 * np.pi * number / _AZIMUTHS
            highest = np.full(x.shape, -1.0)
            for stride in range(1, _STRIDES + 1):
                # nearer ones lie closer
                distance = _FARTHEST * (stride / _STRIDES) ** 1.5
                at_x, at_y = x + distance * np.cos(phi), y + distance * np.sin(phi)
                rise = height(at_x, at_y) - ground
                there = (np.abs(at_x) <= 1.0) & (np.abs(at_y) <= 1.0)
                up = np.where(there, rise / np.hypot(rise, distance), -1.0)
                highest = np.maximum(highest, up)
            sine[number] = highest.ravel()
        return Horizon(sine)

    def around(self, place: Array) -> Around:
        """Return the nodes about places, shape (n, 2)."""
        at = (place.clip(-1.0, 1.0) + 1.0) / 2.0 * (_SIDE - 1)
        low = np.minimum(at.astype(int), _SIDE - 2)
        (u, v), (column, row) = (at - low).T, low.T
        first = row * _SIDE + column
        node = np.stack([first, first + 1, first + _SIDE, first + _SIDE + 1], axis=-1)
        weight = np.stack([(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v], axis=-1)
        return Around(node, weight)

    def lit(self, around: Around, light: Array) -> Array:
        """Return the share of a light that arrives, shape (n,).

        Parameters
        ----------
        around
            The places.
        light
            Direction in the relief's own frame, shape (3,).
        """
        turn = np.arctan2(light[1], light[0]) / (2.0 * np.pi) * _AZIMUTHS % _AZIMUTHS
        low, share = int(turn) % _AZIMUTHS, turn % 1.0
        sine = (1.0 - share) * self.sine[low] + share * self.sine[(low + 1) % _AZIMUTHS]
        above = light[2] - (sine[around.node] * around.weight).sum(axis=1)
        edge = (above / _SOFT + 0.5).clip(0.0, 1.0)
        return np.asarray(edge * edge * (3.0 - 2.0 * edge))
