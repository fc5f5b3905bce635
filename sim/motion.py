"""Motion of one axis as a closed form of time: pieces of constant acceleration."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

Phase = tuple[float, float]
"""Duration in s and acceleration of one piece."""


@dataclass(frozen=True)
class _Piece:
    start_s: float
    position: float
    velocity: float
    acceleration: float

    def at(self, time_s: float) -> tuple[float, float]:
        past = time_s - self.start_s
        velocity = self.velocity + self.acceleration * past
        return self.position + 0.5 * (self.velocity + velocity) * past, velocity


@dataclass(frozen=True)
class Motion:
    """Where an axis is at any time; it stands at `end` from `end_s` on.

    Positions are in any unit u, velocities in u/s, accelerations in u/s2. `acceleration` is the
    magnitude that every ramp has. Pieces count time from `start_s`, since a clock that has run
    for weeks has few digits left for a short ramp.
    """

    start_s: float
    pieces: tuple[_Piece, ...]
    end_s: float
    end: float
    acceleration: float

    def at(self, time_s: float) -> tuple[float, float]:
        """Return position and velocity."""
        if time_s >= self.end_s:
            return self.end, 0.0
        past_s = time_s - self.start_s
        current = self.pieces[0]
        for piece in self.pieces[1:]:
            if piece.start_s > past_s:
                break
            current = piece
        return current.at(past_s)


def rest(position: float) -> Motion:
    """Return no motion at all."""
    return Motion(-math.inf, (), -math.inf, position, 0.0)


def stop(time_s: float, position: float, velocity: float, acceleration: float) -> Motion:
    """Return the ramp that ends a motion."""
    end = _stopping_point(position, velocity, acceleration)
    return _chain(time_s, position, velocity, [_brake(velocity, acceleration)], end, acceleration)


def go(
    time_s: float,
    position: float,
    velocity: float,
    target: float,
    max_velocity: float,
    acceleration: float,
) -> Motion:
    """Return the quickest trapezoid (or triangle) from a running start to rest at `target`.

    An axis that moves away from the target, or too fast to stop before it, stops first. With
    `max_velocity` 0 the motion never ends.
    """
    nearest = _stopping_point(position, velocity, acceleration)
    side = math.copysign(1.0, target - nearest)
    if nearest == target:
        phases = [_brake(velocity, acceleration)]
    elif velocity * side < 0:
        phases = [
            _brake(velocity, acceleration),
            *_trapezoid(abs(target - nearest), 0.0, max_velocity, side, acceleration),
        ]
    else:
        phases = _trapezoid(abs(target - position), abs(velocity), max_velocity, side, acceleration)
    return _chain(time_s, position, velocity, phases, target, acceleration)


def _trapezoid(
    distance: float, speed: float, max_speed: float, side: float, acceleration: float
) -> list[Phase]:
    """Return the phases over `distance`, from `speed` to rest, along `side`."""
    peak = min(max_speed, math.sqrt(acceleration * distance + 0.5 * speed * speed))
    ramps = (abs(peak * peak - speed * speed) + peak * peak) / (2.0 * acceleration)
    # rounding may leave the rest a hair below zero
    cruise_s = max(distance - ramps, 0.0) / peak if peak else math.inf
    return [
        (abs(peak - speed) / acceleration, math.copysign(acceleration, (peak - speed) * side)),
        (cruise_s, 0.0),
        (peak / acceleration, -side * acceleration),
    ]


def _brake(velocity: float, acceleration: float) -> Phase:
    return abs(velocity) / acceleration, -math.copysign(acceleration, velocity)


def _stopping_point(position: float, velocity: float, acceleration: float) -> float:
    return position + velocity * abs(velocity) / (2.0 * acceleration)


def _chain(
    time_s: float,
    position: float,
    velocity: float,
    phases: Iterable[Phase],
    end: float,
    acceleration: float,
) -> Motion:
    pieces, past_s = [], 0.0
    for duration_s, rate in phases:
        if duration_s > 0:
            piece = _Piece(past_s, position, velocity, rate)
            pieces.append(piece)
            past_s += duration_s
            if math.isfinite(past_s):
                position, velocity = piece.at(past_s)
    return Motion(time_s, tuple(pieces), time_s + past_s, end, acceleration)
