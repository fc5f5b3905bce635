"""Lights: from where they reach a surface, and how strongly.

A strength is the irradiance on a surface that faces the light, relative to that of other lights.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from gonio.validation import Document, within
from planner.scene.quantities import (
    Days,
    Hours,
    Point,
    Size,
    Turn,
    Weight,
    between,
    toward,
    within_cone,
)

if TYPE_CHECKING:
    from planner.scene.quantities import Array

_UP = np.array([0.0, 0.0, 1.0])
_CLEAR = 0.7
"""Share of the sun's light that comes through the air straight from above."""


class Arriving(NamedTuple):
    """Light at n points: unit vectors towards it, shape (n, 3), and its strength, shape (n,)."""

    direction: Array
    strength: Array


class _Light(Document):
    weight: Weight = 1.0

    def arriving(self, random: Array, point: Array) -> Arriving:
        """Return light at points (n, 3) in metres for numbers from 0 to 1 of shape (n, 2).

        The mean of strength times cosine over the numbers is the irradiance, at weight 1.
        """
        raise NotImplementedError


class DirectionLight(_Light):
    """A far light within `spread_deg` of a direction; weight: irradiance facing it."""

    kind: Literal["direction"]
    elevation_deg: Annotated[float, within(-90, 90)]
    azimuth_deg: Turn = 180.0
    spread_deg: Annotated[float, within(0, 180)] = 0.0

    def arriving(self, random: Array, point: Array) -> Arriving:
        """Spread evenly over the cone, whatever the point."""
        middle = toward(np.radians(self.elevation_deg), np.radians(self.azimuth_deg))
        direction = within_cone(middle, np.radians(self.spread_deg), *random.T)
        return Arriving(direction, np.ones(len(point)))


class Sun(_Light):
    """The sun on its way through the day; weight: irradiance facing it, were it overhead."""

    kind: Literal["sun"]
    latitude_deg: Annotated[float, within(-90, 90)]
    day_of_year: Days = (1.0, 365.0)
    solar_hour: Hours = (0.0, 24.0)

    def arriving(self, random: Array, point: Array) -> Arriving:
        """Declination by Cooper (1969); dimmed by the air as Meinel and Meinel (1976) have it."""
        day, hour = between(self.day_of_year, random[:, 0]), between(self.solar_hour, random[:, 1])
        declination = np.radians(23.45) * np.sin(2 * np.pi * (284 + day) / 365)
        hour_angle = np.radians(15) * (hour - 12)
        latitude = np.radians(self.latitude_deg)
        east = -np.cos(declination) * np.sin(hour_angle)
        equator = np.cos(declination) * np.cos(hour_angle)
        north = np.sin(declination) * np.cos(latitude) - equator * np.sin(latitude)
        up = np.sin(declination) * np.sin(latitude) + equator * np.cos(latitude)
        return Arriving(np.stack([east, north, up], axis=-1), _through_air(up))


class Sky(_Light):
    """The whole sky, of even luminance or overcast; weight: irradiance on level ground."""

    kind: Literal["sky"]
    luminance: Literal["uniform", "overcast"] = "uniform"

    def arriving(self, random: Array, point: Array) -> Arriving:
        """Overcast: three times as bright above as at the horizon (CIE S 011, type 16)."""
        direction = within_cone(_UP, np.pi / 2, *random.T)
        if self.luminance == "uniform":
            return Arriving(direction, np.full(len(point), 2.0))
        # 7/9 pi of the luminance above falls on level ground
        return Arriving(direction, 2 * np.pi * 9 / (7 * np.pi) * (1 + 2 * direction[:, 2]) / 3)


class Ground(_Light):
    """Light that even, level ground throws back; weight: irradiance on what faces down."""

    kind: Literal["ground"]

    def arriving(self, random: Array, point: Array) -> Arriving:
        """As an even sky, from below."""
        return Arriving(within_cone(-_UP, np.pi / 2, *random.T), np.full(len(point), 2.0))


class Ceiling(_Light):
    """A level panel that shines down; weight: irradiance on level ground, were it endless."""

    kind: Literal["ceiling"]
    centre_m: Point
    size_m: Size

    @model_validator(mode="after")
    def _has_an_area(self) -> Ceiling:
        if not min(self.size_m) > 0:
            raise ValueError("size_m needs two lengths above 0, to the east and to the north")
        return self

    def arriving(self, random: Array, point: Array) -> Arriving:
        """By the inverse square of the distance and the panel's own cosine."""
        place = np.array(self.centre_m) + np.pad(self.size_m * (random - 0.5), ((0, 0), (0, 1)))
        way = place - point
        distance = np.linalg.norm(way, axis=-1).clip(min=1e-6)
        direction = way / distance[:, None]
        area = self.size_m[0] * self.size_m[1]
        cosine = direction[:, 2].clip(min=0.0)
        return Arriving(direction, area * cosine / (np.pi * distance**2))


Light = Annotated[DirectionLight | Sun | Sky | Ground | Ceiling, Field(discriminator="kind")]


def _through_air(sine: Array) -> Array:
    """Return the share of the sun's light that arrives at a sine of its elevation, 1 overhead."""
    elevation_deg = np.degrees(np.arcsin(sine.clip(0.0, 1.0)))
    # air mass by Kasten and Young (1989)
    mass = 1 / (sine.clip(min=0.0) + 0.50572 * (elevation_deg + 6.07995) ** -1.6364)
    return np.where(sine > 0, _CLEAR ** (mass**0.678 - 1), 0.0)
