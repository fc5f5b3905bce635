"""Light from all around, made by formulas, and the lights that stand for it.

In the frame of a picture x is right, y up and z towards the eye.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.directions import normalize

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_ROWS, _COLUMNS = 256, 512
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
# of the lights a share is spread evenly, or what is dark would be told by very few
_EVEN = 0.15
_GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


class Lights(NamedTuple):
    """Directions that stand for a probe.

    Attributes
    ----------
    direction
        Unit vectors towards the lights, shape (n, 3).
    power
        Radiance times the solid angle that each stands for, linear RGB, shape (n, 3).
    """

    direction: Array
    power: Array


@dataclass(frozen=True)
class Probe:
    """Radiance from every direction.

    Attributes
    ----------
    description
        One line.
    radiance
        From unit vectors, shape (..., 3), to linear RGB, shape (..., 3).
    """

    description: str
    radiance: Callable[[Array], Array]

    def panorama(self) -> Array:
        """Return it as a picture by latitude and longitude, shape (256, 512, 3), up on top.

        The middle column looks away from the eye, to -z, and columns go to the right.
        """
        rows = (np.arange(_ROWS) + 0.5) / _ROWS
        columns = (np.arange(_COLUMNS) + 0.5) / _COLUMNS
        return self.radiance(_direction(np.cos(np.pi * rows)[:, None], columns[None]))

    def lights(self, count: int) -> Lights:
        """Return lights by importance, the same at every call.

        The points of a Fibonacci lattice (one stratum a light in one direction, multiples of the
        golden ratio in the other) go through the inverse of the cumulative luminance, rows first
        and then within the row, as Pharr, Jakob and Humphreys describe it (Physically Based
        Rendering, 14.2.4). Every fourth of them is spread as evenly as all.

        Parameters
        ----------
        count
            How many, at least 1.
        """
        density = self._density()
        u = (np.arange(count) + 0.5) / count
        v = np.arange(count) * _GOLDEN % 1.0
        marginal = density.sum(axis=1)
        row, within = _invert(marginal[None], u, np.zeros(count, int))
        column, along = _invert(density, v, row)
        edges = np.cos(np.pi * np.arange(_ROWS + 1) / _ROWS)
        height = edges[row] + within * (edges[row + 1] - edges[row])
        direction = _direction(height, (column + along) / _COLUMNS)
        # density is of a cell as a whole, and light is spread evenly over its solid angle
        cell = (edges[row] - edges[row + 1]) * 2.0 * np.pi / _COLUMNS
        probability = density[row, column] / density.sum() / cell
        return Lights(direction, self.radiance(direction) / (count * probability)[:, None])

    def _density(self) -> Array:
        """Return how likely each cell of the panorama is, up to a factor, shape (256, 512)."""
        edges = np.cos(np.pi * np.arange(_ROWS + 1) / _ROWS)
        area = (edges[:-1] - edges[1:])[:, None] / _COLUMNS
        bright = (self.panorama() @ _LUMINANCE) * area
        even = area / area.sum() / _COLUMNS
        return np.asarray((1.0 - _EVEN) * bright / bright.sum() + _EVEN * even)


def _direction(height: Array, turn: Array) -> Array:
    """Return unit vectors of a height (y) and a share of the turn about it, from +z by -x."""
    height, turn = np.broadcast_arrays(height, turn)
    level, phi = np.sqrt((1.0 - height**2).clip(0.0)), 2.0 * np.pi * turn
    return np.stack([-level * np.sin(phi), height, level * np.cos(phi)], axis=-1)


def _invert(density: Array, u: Array, row: NDArray[np.int64]) -> tuple[NDArray[np.int64], Array]:
    """Return the cell of a row in which its cumulative density reaches u, and where within."""
    total = np.cumsum(density, axis=1)
    total /= total[:, -1:]
    # one sorted search for all rows, each lifted above the one before
    cell = np.searchsorted((total + np.arange(len(total))[:, None]).ravel(), u + row)
    cell = np.clip(cell - row * total.shape[1], 0, total.shape[1] - 1)
    above = total[row, cell]
    below = np.where(cell > 0, total[row, cell - 1], 0.0)
    return cell, ((u - below) / (above - below)).clip(0.0, 1.0)


def _towards(height_deg: float, turn_deg: float) -> Array:
    """Return the direction at a height, turned to the right from the eye's own side."""
    height, turn = np.radians([height_deg, turn_deg])
    level = np.cos(height)
    return np.array([level * np.sin(turn), np.sin(height), level * np.cos(turn)])


def _panel(direction: Array, centre: Array, half_width_deg: float, half_height_deg: float) -> Array:
    """Return 1 within a rectangle about a centre and 0 outside, soft at its edge."""
    right = normalize(np.cross([0.0, 1.0, 0.0], centre))
    up = np.cross(centre, right)
    ahead = direction @ centre
    ahead_safe = np.where(ahead > 0.05, ahead, 1.0)
    inside = np.where(ahead > 0.05, 1.0, 0.0)
    for axis, half_deg in ((right, half_width_deg), (up, half_height_deg)):
        half = np.tan(np.radians(half_deg))
        inside = inside * _smooth((half - np.abs(direction @ axis / ahead_safe)) / (0.1 * half))
    return inside


def _smooth(x: Array) -> Array:
    x = x.clip(0.0, 1.0)
    return np.asarray(x * x * (3.0 - 2.0 * x))


def _studio(direction: Array) -> Array:
    """A large softbox from the upper left, a strip from the right, a dim room."""
    key = _panel(direction, _towards(42.0, -48.0), 17.0, 17.0)
    strip = _panel(direction, _towards(12.0, 78.0), 6.0, 32.0)
    room = 0.5 + 0.5 * direction[..., 1]
    colored = 14.0 * key[..., None] * np.array([1.0, 0.97, 0.92])
    colored = colored + 9.0 * strip[..., None] * np.array([0.86, 0.93, 1.0])
    return np.asarray(colored + (0.06 + 0.16 * room)[..., None])


def _sky(direction: Array) -> Array:
    """A blue sky, paler at the horizon, a sun of 5 deg and a brownish ground."""
    height = direction[..., 1:2]
    pale, blue = np.array([0.85, 0.90, 0.95]), np.array([0.22, 0.42, 0.85])
    sky = pale + (blue - pale) * height.clip(0.0) ** 0.5
    ground = np.array([0.16, 0.13, 0.10]) * np.ones_like(height)
    # the real one is 0.53 deg wide; a hundredth of its radiance over a hundred times its area
    # gives the same irradiance, and highlights that 81 x 81 pairs can tell
    off = np.degrees(np.arccos((direction @ _towards(40.0, -38.0)).clip(-1.0, 1.0)))
    sun = _smooth((2.8 - off) / 0.6)[..., None] * np.array([1.0, 0.93, 0.80])
    return np.asarray(np.where(height > 0, sky, ground) * 0.6 + 320.0 * sun)


def _even(direction: Array) -> Array:
    """1 from everywhere."""
    return np.ones(np.shape(direction))


PROBES: dict[str, Probe] = {
    "studio": Probe("a softbox from the upper left, a strip light from the right", _studio),
    "sky": Probe("a blue sky with a sun 40 deg high, over brown ground", _sky),
    "furnace": Probe("1 from everywhere: a perfect diffuser vanishes", _even),
}
"""By name, in the order in which they are listed."""
