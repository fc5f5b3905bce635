"""Surfaces that carry the material: where they are, which way they face, how they bend."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from gonio.validation import Document, within
from planner.scene.quantities import Point, Size, Turn, Weight, rotate

if TYPE_CHECKING:
    from planner.scene.quantities import Array

_UP = np.array([0.0, 0.0, 1.0])


class Elements(NamedTuple):
    """Small pieces of a surface.

    Attributes
    ----------
    frame
        Unit vectors in the world, shape (n, 3, 3): marked edge, across it, normal.
    point
        Where they are, in metres, shape (n, 3).
    """

    frame: Array
    point: Array


class _Surface(Document):
    """What all surfaces say of themselves.

    `tilt_deg` is how far the normal leans from straight up: 0 a table, 90 a wall, 180 a ceiling.
    `azimuth_deg` is the bearing that it faces. `grain_deg` is the angle of the sample's marked edge
    from the horizontal, counter-clockwise as seen from outside. `turn_deg` lets the surface turn
    by so much in all about the vertical through the origin, as on a turntable.
    """

    tilt_deg: Annotated[float, within(0, 180)]
    azimuth_deg: Turn = 180.0
    grain_deg: Turn = 0.0
    turn_deg: Annotated[float, within(0, 360)] = 0.0
    centre_m: Point = (0.0, 0.0, 0.0)
    size_m: Size = (0.0, 0.0)
    weight: Weight = 1.0

    def elements(self, random: Array) -> Elements:
        """Return pieces for numbers from 0 to 1 of shape (n, 5); all have the same area."""
        right, up, normal = self._middle()
        offset = self.size_m * (random[:, 3:] - 0.5)
        point = self.centre_m + offset @ np.stack([right, up])
        grain = np.radians(self.grain_deg)
        edge = np.cos(grain) * right + np.sin(grain) * up
        turn = np.radians(self.turn_deg) * (random[:, 2] - 0.5)
        direction, angle = self._bend(random[:, 0], random[:, 1])
        axis = np.cos(direction)[:, None] * right + np.sin(direction)[:, None] * up
        middle = (edge, np.cross(normal, edge), normal)
        frame = [rotate(rotate(each, axis, angle), _UP, turn) for each in middle]
        return Elements(np.stack(frame, axis=1), rotate(point, _UP, turn))

    def _middle(self) -> tuple[Array, Array, Array]:
        """Return right and up within the surface as seen from outside, and its normal."""
        tilt, bearing = np.radians(self.tilt_deg), np.radians(self.azimuth_deg)
        faces = np.array([np.sin(bearing), np.cos(bearing), 0.0])
        normal = np.sin(tilt) * faces + np.cos(tilt) * _UP
        # from the bearing, not from the normal: a surface that faces up has a right side, too
        right = np.cross(_UP, faces)
        return right, np.cross(normal, right), normal

    def _bend(self, first: Array, second: Array) -> tuple[Array, Array]:
        """Return the axis, as its angle within the surface, and the angle of each piece's bend."""
        raise NotImplementedError


class Flat(_Surface):
    """A plane."""

    shape: Literal["flat"]

    def _bend(self, first: Array, second: Array) -> tuple[Array, Array]:
        return np.zeros_like(first), np.zeros_like(first)


class Cylinder(_Surface):
    """Bent about one axis, `axis_deg` from the horizontal, its normals over `arc_deg` in all."""

    shape: Literal["cylinder"]
    axis_deg: Turn = 90.0
    arc_deg: Annotated[float, within(0, 360)]

    def _bend(self, first: Array, second: Array) -> tuple[Array, Array]:
        axis = np.full_like(first, np.radians(self.axis_deg))
        return axis, np.radians(self.arc_deg) * (first - 0.5)


class Sphere(_Surface):
    """A patch of a sphere, its normals within a cone `arc_deg` wide."""

    shape: Literal["sphere"]
    arc_deg: Annotated[float, within(0, 360)]

    def _bend(self, first: Array, second: Array) -> tuple[Array, Array]:
        # even in area: the versine is even (Archimedes)
        sine = np.sin(np.radians(self.arc_deg) / 4) * np.sqrt(first)
        return 2 * np.pi * second, 2 * np.arcsin(sine)


Surface = Annotated[Flat | Cylinder | Sphere, Field(discriminator="shape")]
