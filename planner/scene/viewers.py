"""Viewers: from where a surface is seen, and how large it looks from there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from gonio.validation import Document, within
from planner.scene.quantities import (
    Distances,
    Heights,
    Place,
    Point,
    Turn,
    Weight,
    between,
    toward,
    within_cone,
)

if TYPE_CHECKING:
    from planner.scene.quantities import Array

_NEAREST_M = 0.1
"""No eye looks from nearer (its near point); so a path may lead through a surface."""


class Seen(NamedTuple):
    """An eye from n points: unit vectors towards it, shape (n, 3), and its distance in m, (n,)."""

    direction: Array
    distance: Array


class _Viewer(Document):
    weight: Weight = 1.0

    def seen(self, random: Array, point: Array) -> Seen:
        """Return the eye as seen from points (n, 3) in metres, for numbers from 0 to 1, (n, 3)."""
        way = self._places(random) - point
        distance = np.linalg.norm(way, axis=-1)
        direction = way / np.where(distance > 0, distance, 1.0)[:, None]
        return Seen(direction, distance.clip(min=_NEAREST_M))

    def _places(self, random: Array) -> Array:
        """Return where the eye is, shape (n, 3), in metres."""
        raise NotImplementedError


class FarViewer(_Viewer):
    """A far eye within `spread_deg` of a direction."""

    kind: Literal["direction"]
    elevation_deg: Annotated[float, within(-90, 90)]
    azimuth_deg: Turn = 180.0
    spread_deg: Annotated[float, within(0, 180)] = 0.0

    def seen(self, random: Array, point: Array) -> Seen:
        """Spread evenly over the cone, as far from every point."""
        middle = toward(np.radians(self.elevation_deg), np.radians(self.azimuth_deg))
        direction = within_cone(middle, np.radians(self.spread_deg), random[:, 0], random[:, 1])
        return Seen(direction, np.ones(len(point)))


class Standing(_Viewer):
    """An eye at a place."""

    kind: Literal["position"]
    position_m: Point

    def _places(self, random: Array) -> Array:
        return np.broadcast_to(np.array(self.position_m), random.shape)


class Walking(_Viewer):
    """An eye that goes along a line of points at an even pace, at a height or heights."""

    kind: Literal["path"]
    points_m: tuple[tuple[Place, Place], ...] = Field(min_length=2)
    height_m: Heights = (1.6, 1.6)

    def _places(self, random: Array) -> Array:
        points = np.array(self.points_m)
        way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        at = random[:, 0] * way[-1]
        columns = [np.interp(at, way, points[:, i]) for i in (0, 1)]
        return np.stack([*columns, between(self.height_m, random[:, 1])], axis=-1)


class Around(_Viewer):
    """An eye anywhere about the origin, at distances and heights."""

    kind: Literal["around"]
    distance_m: Distances
    height_m: Heights = (1.6, 1.6)

    def _places(self, random: Array) -> Array:
        level = toward(0.0, 2 * np.pi * random[:, 0])
        place = between(self.distance_m, random[:, 1])[:, None] * level
        place[:, 2] = between(self.height_m, random[:, 2])
        return place


Viewer = Annotated[FarViewer | Standing | Walking | Around, Field(discriminator="kind")]
