"""How long the arms take from one shot to another.

Both arms and both axes of each move together, so a move takes as long as its slowest axis; then
axes that are approached from one side make their run-up, together again. Each arm has few places
to stand at: small tables hold all times, whatever the number of shots.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from gonio.approach import first_stop_deg
from gonio.timemodel import move_time

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import Rig
    from gonio.timing import Timing
    from planner.places import Places

    Array = NDArray[np.float64]
    Indices = NDArray[np.int64]


@dataclass(frozen=True)
class ArmTimes:
    """Seconds between the places of one arm, from rows to columns.

    Attributes
    ----------
    go_s
        To the place, or to where the run-up to it begins, shape (p, p).
    run_s
        The run-up, shape (p, p).
    """

    go_s: Array
    run_s: Array

    @classmethod
    def of(cls, angles_deg: Array, rig: Rig, timing: Timing | None, arm: str) -> ArmTimes:
        """Make the tables of an arm ("view", "light") whose axes stand at angles, shape (p, 2)."""
        theta, phi = (
            _axis_times(angles_deg[:, i], rig, timing, f"{arm}_{name}")
            for i, name in enumerate(("theta", "phi"))
        )
        return cls(*np.maximum(theta, phi))

    def least(self, first: Indices) -> ArmTimes:
        """Return the least times between groups of places that begin at `first`."""
        tables = (
            np.minimum.reduceat(np.minimum.reduceat(table, first, 0), first, 1)
            for table in (self.go_s, self.run_s)
        )
        return ArmTimes(*tables)

    @property
    def either_way(self) -> ArmTimes:
        """The lesser of the times of each move and of its reverse."""
        return ArmTimes(*(np.minimum(table, table.T) for table in (self.go_s, self.run_s)))


def _axis_times(angles_deg: Array, rig: Rig, timing: Timing | None, name: str) -> Array:
    starts, goals = angles_deg[:, None], angles_deg[None]
    stops = first_stop_deg(starts, goals, rig.axis[name])
    acts = rig.axis[name] if timing is None else timing.axis[name]
    return move_time(np.stack([stops - starts, goals - stops]), acts)


@dataclass(frozen=True)
class TimeMetric:
    """Seconds between shots.

    Attributes
    ----------
    view, light
        Tables of each arm, of v and l places.
    poses
        The places of view and light at each shot, shape (n, 2).
    slow_keys, slow_s
        Moves between poses that take longer than their axes need, by `key`, rising, and how long;
        shape (m,) each.
    """

    view: ArmTimes
    light: ArmTimes
    poses: Indices
    slow_keys: Indices = field(default_factory=lambda: np.empty(0, np.int64))
    slow_s: Array = field(default_factory=lambda: np.empty(0))

    @classmethod
    def of(cls, angles_deg: Array, rig: Rig, timing: Timing | None = None) -> TimeMetric:
        """Make the tables of shots whose axes stand at `angles_deg`, shape (n, 4), as in AXES.

        Without a `timing`, the rig acts just as its rig file says.
        """
        views, view = np.unique(angles_deg[:, :2], axis=0, return_inverse=True)
        lights, light = np.unique(angles_deg[:, 2:], axis=0, return_inverse=True)
        return cls(
            ArmTimes.of(views, rig, timing, "view"),
            ArmTimes.of(lights, rig, timing, "light"),
            np.stack([view.reshape(-1), light.reshape(-1)], axis=1),
        )

    @classmethod
    def between_places(
        cls, view: Places, light: Places, rig: Rig, timing: Timing | None = None
    ) -> TimeMetric:
        """Make the tables of all places; the shots are at their plain ones."""
        return cls(
            ArmTimes.of(view.angles_deg, rig, timing, "view"),
            ArmTimes.of(light.angles_deg, rig, timing, "light"),
            np.stack([view.plain, light.plain], axis=1),
        )

    @classmethod
    def of_one_arm(cls, times: ArmTimes) -> TimeMetric:
        """Make the metric of one arm's places alone."""
        still = np.zeros((1, 1))
        places = np.arange(len(times.go_s))
        return cls(times, ArmTimes(still, still), np.stack([places, 0 * places], axis=1))

    def __len__(self) -> int:
        return len(self.poses)

    @property
    def is_symmetric(self) -> bool:
        """Whether every move takes as long as its reverse."""
        tables = (self.view.go_s, self.view.run_s, self.light.go_s, self.light.run_s)
        return not len(self.slow_keys) and all((table == table.T).all() for table in tables)

    def between(self, a: Indices | np.int64, b: Indices | np.int64) -> Array:
        """Return the seconds from shots `a` to shots `b`."""
        return self.times(self.poses[a], self.poses[b])

    def times(self, a: Indices, b: Indices) -> Array:
        """Return the seconds from poses `a` to poses `b`, shapes (..., 2), broadcast."""
        view, light = (a[..., 0], b[..., 0]), (a[..., 1], b[..., 1])
        go_s = np.maximum(self.view.go_s[view], self.light.go_s[light])
        time_s = go_s + np.maximum(self.view.run_s[view], self.light.run_s[light])
        if not len(self.slow_keys):
            return np.asarray(time_s)
        keys = self.key(a, b)
        at = np.searchsorted(self.slow_keys, keys).clip(max=len(self.slow_keys) - 1)
        return np.where(self.slow_keys[at] == keys, self.slow_s[at], time_s)

    def key(self, a: Indices, b: Indices) -> Indices:
        """Return the number of each move from poses `a` to poses `b`, shapes (..., 2)."""
        lights = len(self.light.go_s)
        start, goal = (pose[..., 0] * lights + pose[..., 1] for pose in (a, b))
        return np.asarray(start * (len(self.view.go_s) * lights) + goal)

    @property
    def slow_moves(self) -> tuple[Indices, Indices]:
        """The poses that slow moves start from and go to, shapes (m, 2)."""
        shape = (len(self.view.go_s), len(self.light.go_s)) * 2
        ends = np.stack(np.unravel_index(self.slow_keys, shape), axis=1)
        return ends[:, :2], ends[:, 2:]

    def with_slow(self, a: Indices, b: Indices, time_s: Array) -> TimeMetric:
        """Return the metric in which moves between poses, shapes (m, 2), take `time_s` instead."""
        keys = np.append(self.key(a, b), self.slow_keys)
        keys, first = np.unique(keys, return_index=True)
        return replace(self, slow_keys=keys, slow_s=np.append(time_s, self.slow_s)[first])

    def least(self, view: Places, light: Places) -> TimeMetric:
        """Return the metric of directions, each move as short as any places of both allow."""
        return TimeMetric(
            self.view.least(view.first),
            self.light.least(light.first),
            np.stack([view.direction, light.direction], axis=1),
        )

    @property
    def either_way(self) -> TimeMetric:
        """The symmetric metric of the lesser of each move's time and its reverse's."""
        return replace(self, view=self.view.either_way, light=self.light.either_way)

    def total(self, order: Indices) -> float:
        """Return the seconds of the moves of a route, shot numbers of shape (n,)."""
        return float(self.between(order[:-1], order[1:]).sum())
