"""What the arms sweep on a move: whether they keep clear of every limit on the way.

All axes start together, each on its own trapezoid profile from rest to rest, so where they are at
any time is known. Time is bisected: a stretch is clear when the margin in its middle (see
`gonio.clearance`) exceeds what the arms turn within it, else it is halved. So nothing lies between
two looks, and stretches far from any limit take few of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.clearance import ROUND_OFF, limits_of
from gonio.rig import AXES
from gonio.timemodel import move_time

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.clearance import Limit
    from gonio.rig import Rig

    Array = NDArray[np.float64]

START_SKEW_S = 0.03
"""How far apart the starts of axes may be that are told to start together."""

SPARE = math.radians(0.1)
"""What a way keeps beyond every limit, unless its own ends are nearer to that limit."""

_FINE = SPARE / 2
"""What the arms may turn within a stretch that is not halved any more."""

_LOOKS = 300
"""How often a move out of a limit is looked at."""

_BATCH = 20_000
"""Moves that are looked at together, so that their arrays stay in the processor's cache."""


@dataclass(frozen=True)
class _Profiles:
    """The trapezoid profiles of some axes on n moves, shapes (n, axes), in degrees and seconds."""

    start: Array
    step: Array
    ramp_s: Array
    end_s: Array
    acceleration: Array

    @classmethod
    def of(cls, start: Array, goal: Array, rig: Rig, columns: tuple[int, ...]) -> _Profiles:
        axes = [rig.axis[AXES[column]] for column in columns]
        step = goal - start
        speed = np.array([axis.max_velocity_deg_s for axis in axes])
        acceleration = np.array([axis.max_acceleration_deg_s2 for axis in axes])
        ramp_s = np.minimum(speed / acceleration, np.sqrt(np.abs(step) / acceleration))
        end_s = np.stack([move_time(step[:, i], axis) for i, axis in enumerate(axes)], axis=1)
        return cls(start, step, ramp_s, end_s, acceleration)

    def __len__(self) -> int:
        return len(self.start)

    def take(self, rows: NDArray[np.int64]) -> _Profiles:
        return _Profiles(
            self.start[rows],
            self.step[rows],
            self.ramp_s[rows],
            self.end_s[rows],
            self.acceleration,
        )

    def at(self, time_s: Array) -> Array:
        """Return the angles at times of shape (n, 1) or (n, axes), which may be before or after."""
        time_s = np.clip(time_s, 0.0, self.end_s)
        starting = np.maximum(self.ramp_s - time_s, 0.0)
        ending = np.maximum(time_s - self.end_s + self.ramp_s, 0.0)
        cruise = self.ramp_s * (time_s - 0.5 * self.ramp_s)
        way = self.acceleration * (cruise + 0.5 * (starting * starting - ending * ending))
        # round-off must not carry an axis beyond its ends
        way = np.minimum(np.maximum(way, 0.0), np.abs(self.step))
        return np.asarray(self.start + np.copysign(way, self.step))

    def skew_s(self) -> Array:
        """Return by how much each axis may be early or late against the quickest of a move."""
        quickest = np.argmax(self.acceleration * self.ramp_s * self._swing(), axis=1)
        skew = np.full(self.step.shape, START_SKEW_S)
        skew[np.arange(len(skew)), quickest] = 0.0
        return skew

    def _swing(self) -> Array:
        """Return the most that a degree of each axis turns its arm, in degrees."""
        theta = np.maximum(np.abs(self.start), np.abs(self.start + self.step))
        return _weights(np.minimum(theta, 90.0))


def leg_blocked(start_deg: Array, goal_deg: Array, rig: Rig) -> NDArray[np.bool_]:
    """Return which straight moves come too near to something, shape (n,).

    A move may be as near to a limit as the nearer of its ends, as far as those are free by the
    encoders, which may be off by `in_position_deg`. From further inside a limit it must lead out:
    the margin may not fall before it is above 0.

    Parameters
    ----------
    start_deg, goal_deg
        Poses, shape (n, 4) each.
    """
    blocked = np.zeros(len(start_deg), dtype=bool)
    for limit in limits_of(rig):
        legs = np.concatenate([start_deg[:, limit.columns], goal_deg[:, limit.columns]], axis=1)
        # one arm goes few different ways, whatever the other does
        legs, which = np.unique(legs, axis=0, return_inverse=True)
        batches = np.split(legs, range(_BATCH, len(legs), _BATCH))
        blocked |= np.concatenate([_runs_into(limit, batch, rig) for batch in batches])[which]
    return blocked


def _runs_into(limit: Limit, legs: Array, rig: Rig) -> NDArray[np.bool_]:
    """Return which legs, starts beside goals in the limit's columns, come too near to it."""
    start, goal = np.split(legs, 2, axis=1)
    # however loose the encoders: what is wholly inside a limit is inside
    inside = -min(encoder_tolerance(rig), 0.5 * limit.deepest)
    ends = limit.margin(start), limit.margin(goal)
    nearer = np.minimum(*ends)
    trapped, blocked = (margin < inside for margin in ends)
    profiles = _Profiles.of(start, goal, rig, limit.columns)
    moves = ~blocked & (start != goal).any(axis=1)
    out, along = (np.flatnonzero(moves & (trapped == now)) for now in (True, False))
    blocked[out] = ~_leads_out(limit, profiles.take(out))
    blocked[along] = _swept(limit, profiles.take(along), np.minimum(nearer[along], SPARE) - _FINE)
    return np.asarray(blocked)


def encoder_tolerance(rig: Rig) -> float:
    """Return the radians by which arms in position may be nearer to something than told."""
    return math.radians(sum(rig.axis[name].in_position_deg for name in AXES)) + _FINE


def _swept(limit: Limit, profiles: _Profiles, least: Array) -> NDArray[np.bool_]:
    """Return which moves bring the margin below `least`, shape (n,)."""
    blocked = np.zeros(len(profiles), dtype=bool)
    move, skew_s = np.arange(len(profiles)), profiles.skew_s()
    begin_s = np.full(len(move), -START_SKEW_S)
    end_s = profiles.end_s.max(axis=1) + START_SKEW_S
    while len(move):
        middle_s = 0.5 * (begin_s + end_s)
        some, slack_s = profiles.take(move), skew_s[move]
        pose = some.at(middle_s[:, None])
        spare = limit.margin(pose) - least[move]
        certain = _turned(some, pose, middle_s, middle_s, slack_s)
        passed = _turned(some, pose, begin_s, end_s, slack_s)
        blocked[move[spare < certain]] = True
        halve = (spare < passed) & (passed > certain + _FINE) & ~blocked[move]
        move = np.tile(move[halve], 2)
        begin_s, end_s = (
            np.concatenate([begin_s[halve], middle_s[halve]]),
            np.concatenate([middle_s[halve], end_s[halve]]),
        )
    return blocked


def _leads_out(limit: Limit, profiles: _Profiles) -> NDArray[np.bool_]:
    """Return on which moves the margin never falls while it is below 0, shape (n,)."""
    clear = np.ones(len(profiles), dtype=bool)
    last = np.full(len(profiles), -np.inf)
    for part in np.linspace(0.0, 1.0, _LOOKS) if len(profiles) else ():
        pose = profiles.at(part * profiles.end_s.max(axis=1, keepdims=True))
        short = np.minimum(limit.margin(pose), 0.0)
        clear &= short >= last - ROUND_OFF
        last = short
    return clear


def _turned(some: _Profiles, pose: Array, begin_s: Array, end_s: Array, slack_s: Array) -> Array:
    """Return how far the arms may be from `pose`, in radians, at any time of a stretch, (n,)."""
    early = np.abs(pose - some.at(begin_s[:, None] - slack_s))
    late = np.abs(some.at(end_s[:, None] + slack_s) - pose)
    return np.asarray(np.radians((np.maximum(early, late) * _weights(pose)).sum(axis=1)))


def _weights(pose: Array) -> Array:
    """Return how far each axis' degree turns its arm: theta by 1, phi by the sine of theta.

    From one direction to another goes along the parallel of the first and then a meridian.
    """
    weights = np.ones_like(pose)
    weights[:, 1::2] = np.abs(np.sin(np.radians(pose[:, 0::2])))
    return weights
