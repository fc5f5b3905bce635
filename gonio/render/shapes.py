"""The shapes that pictures show: what the eye sees of them, pixel by pixel.

The eye is far away at +z, x is right and y up; a picture spans -1 to 1 in both.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from gonio.directions import normalize
from gonio.render.horizon import Horizon

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Height = Callable[[Array, Array], Array]

_EYE = np.array([0.0, 0.0, 1.0])
_STEPS, _HALVINGS = 48, 10
_SLOPE_STEP = 1e-4


class Seen(NamedTuple):
    """What the eye sees of a shape through one place of each pixel.

    Attributes
    ----------
    pixel
        Those that see it, counted along the rows, shape (n,).
    frame
        Rows tangent (the marked edge), bitangent and normal, shape (n, 3, 3).
    lit
        From a direction to the share of it that no other part of the shape hides, shape (n,).
    """

    pixel: NDArray[np.int64]
    frame: Array
    lit: Callable[[Array], Array]


class Shape(Protocol):
    """Something that a material can be put on."""

    @property
    def description(self) -> str:
        """One line."""

    def look(self, size_px: int, x: float, y: float) -> Seen:
        """Return what is seen at place (x, y), 0 to 1 from the upper left, of each pixel."""


@dataclass(frozen=True)
class Sphere:
    """A sphere, the marked edge along its circles of latitude."""

    description: str
    radius: float = 0.94

    def look(self, size_px: int, x: float, y: float) -> Seen:
        """Return what is seen at place (x, y) of each pixel."""
        right, up = (each / self.radius for each in _places(size_px, x, y))
        depth = 1.0 - right**2 - up**2
        pixel = np.flatnonzero(depth > 0)
        normal = np.stack([right, up, np.sqrt(depth.clip(0.0))], axis=-1).reshape(-1, 3)[pixel]
        tangent = normalize(np.cross([0.0, 1.0, 0.0], normal))
        frame = np.stack([tangent, np.cross(normal, tangent), normal], axis=1)
        # nothing of a sphere hides another part of it that faces the light
        return Seen(pixel, frame, lambda _: np.ones(len(pixel)))


@dataclass(frozen=True)
class Relief:
    """A height over the square from -1 to 1, seen at a slant.

    Attributes
    ----------
    description
        One line.
    height
        From two coordinates of one shape to the height above the square.
    up, grain
        The square's normal and its first coordinate's direction; these are turned to be at right
        angles.
    scale, shift
        Of the square in the picture.
    """

    description: str
    height: Height
    up: tuple[float, float, float]
    grain: tuple[float, float, float]
    scale: float
    shift: tuple[float, float]

    def look(self, size_px: int, x: float, y: float) -> Seen:
        """Return what is seen at place (x, y) of each pixel, by marching along its ray."""
        right, up = _places(size_px, x, y)
        across = np.stack([right - self.shift[0], up - self.shift[1]], axis=-1).reshape(-1, 2)
        start = np.pad(across / self.scale, ((0, 0), (0, 1)))
        place, hit = self._meet(start @ self.axes.T, self.axes @ _EYE)
        pixel = np.flatnonzero(hit)
        place = place[hit]
        local = frames(self.normal(place), np.array([1.0, 0.0, 0.0]))
        horizon = self._horizon()
        near = horizon.around(place[:, :2])
        return Seen(pixel, local @ self.axes, lambda light: horizon.lit(near, self.axes @ light))

    @property
    def axes(self) -> Array:
        """Rows: the square's two directions and its normal, in the picture's frame."""
        return np.asarray(frames(normalize(np.array([self.up])), np.array(self.grain))[0])

    def _meet(self, start: Array, eye: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Return where rays first meet the relief, shape (n, 3), and which do."""
        top, bottom = ((bound - start[:, 2]) / eye[2] for bound in _bounds(self.height))
        outside, found = top.copy(), np.zeros(len(start), bool)
        inside = top.copy()
        for step in range(1, _STEPS + 1):
            way = top + (bottom - top) * step / _STEPS
            under = ~found & self._is_under(start + way[:, None] * eye)
            inside[under] = way[under]
            found |= under
            outside = np.where(found, outside, way)
        for _ in range(_HALVINGS):
            middle = 0.5 * (outside + inside)
            under = self._is_under(start + middle[:, None] * eye)
            inside, outside = np.where(under, middle, inside), np.where(under, outside, middle)
        # it has no thickness: what comes in below its edge misses it
        from_above = _within(start + outside[:, None] * eye)
        return start + inside[:, None] * eye, found & from_above

    def _is_under(self, place: Array) -> NDArray[np.bool_]:
        below = place[:, 2] < self.height(place[:, 0], place[:, 1])
        return np.asarray(_within(place) & below)

    def normal(self, place: Array) -> Array:
        """Return the surface's unit normals at places of it, shape (n, 3), in its own frame."""
        x, y = place[:, 0], place[:, 1]
        along = (self.height(x + _SLOPE_STEP, y) - self.height(x - _SLOPE_STEP, y)) / 2
        across = (self.height(x, y + _SLOPE_STEP) - self.height(x, y - _SLOPE_STEP)) / 2
        normal = np.stack([-along, -across, np.full(len(x), _SLOPE_STEP)], axis=-1)
        return normalize(normal)

    def _horizon(self) -> Horizon:
        return Horizon.of(self.height)


def frames(normal: Array, along: Array) -> Array:
    """Return rows tangent, bitangent and normal, shape (n, 3, 3); tangents as near `along` as can.

    Parameters
    ----------
    normal
        Unit vectors, shape (n, 3).
    along
        Where the marked edge would like to point, shape (3,).
    """
    tangent = normalize(along - (normal @ along)[:, None] * normal)
    return np.stack([tangent, np.cross(normal, tangent), normal], axis=1)


def _within(place: Array) -> NDArray[np.bool_]:
    return np.asarray((np.abs(place[:, :2]) <= 1.0).all(axis=1))


@cache
def _bounds(height: Height) -> tuple[float, float]:
    """Return a little above the highest point of a relief, and a little below its lowest."""
    steps = np.linspace(-1.0, 1.0, 65)
    heights = height(*np.meshgrid(steps, steps))
    return float(heights.max()) + 0.02, float(heights.min()) - 0.02


def _places(size_px: int, x: float, y: float) -> tuple[Array, Array]:
    right, up = np.meshgrid(
        (np.arange(size_px) + x) / size_px * 2.0 - 1.0,
        1.0 - (np.arange(size_px) + y) / size_px * 2.0,
    )
    return right, up


def _drape(x: Array, y: Array) -> Array:
    """Cloth that hangs in folds, which run together towards one end."""
    spread = 1.0 + 0.25 * y
    folds = 0.16 * np.cos(7.6 * x / spread + 0.5 * np.sin(1.7 * y)) * (0.75 - 0.25 * y)
    small = 0.035 * np.sin(15.0 * x / spread + 2.1 * y) + 0.03 * np.cos(4.0 * y + 3.0 * x)
    return folds + small


def _wing(x: Array, y: Array) -> Array:
    """A wing: bent about its length, with a raised line along it and a bulge over a wheel."""
    bend = -0.42 * y**2 - 0.10 * x**2
    line = 0.05 * np.tanh((y - 0.28 - 0.10 * x) / 0.05)
    distance = np.hypot(x - 0.25, y + 1.05) / 0.62
    bulge = 0.20 * np.exp(-((distance - 1.0) ** 2) / 0.035)
    return bend + line + bulge + 0.12


SHAPES: dict[str, Shape] = {
    "sphere": Sphere("a sphere, the marked edge along its circles of latitude"),
    "drape": Relief(
        "cloth that hangs in folds, the marked edge across them",
        _drape, up=(0.0, 0.35, 1.0), grain=(1.0, 0.0, 0.0), scale=0.86, shift=(0.0, -0.02),
    ),
    "panel": Relief(
        "a car's wing, bent, creased and bulged, the marked edge along it",
        _wing, up=(-0.30, 0.75, 1.0), grain=(1.0, -0.12, 0.0), scale=0.82, shift=(-0.06, 0.10),
    ),
}  # fmt: skip
"""By name, in the order in which they are drawn."""
