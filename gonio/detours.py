"""Ways round: poses to pass on the way from one pose to another.

A way is three legs through poses start, first, second, goal; one that needs fewer begins by
staying at the start.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.approach import first_stop_deg
from gonio.rig import AXES
from gonio.timemodel import move_time

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from gonio.rig import Rig

    Array = NDArray[np.float64]

_STOPS = {"theta": 5, "phi": 8}
"""Angles, evenly over an axis' travel, at which an arm may get out of the way."""


def ways_round(start_deg: Array, goal_deg: Array, rig: Rig) -> Array:
    """Return ways from pose to pose that may be free where the straight one is not, (n, 4, 4).

    One arm goes after the other; one goes elsewhere in between while the other waits or goes; one
    stays elsewhere until the other has passed; one goes up or down, turns, and goes to its goal,
    the other before, meanwhile or after.

    Parameters
    ----------
    start_deg, goal_deg
        Poses, shape (4,) each. The start may be beyond an axis' travel, as a home switch is; what
        an arm that waits is told then is the travel's end.
    """
    start = _within_travel(start_deg, rig)
    # an axis that is approached from one side must not be at its goal before that
    landing = with_approach(np.stack([start, goal_deg]), rig)[-2]
    ends = np.stack([start, landing])
    middles = []
    for own, other in (([0, 1], [2, 3]), ([2, 3], [0, 1])):
        theta, phi = (_stops(column, ends, goal_deg, rig) for column in own)
        places = np.stack(np.meshgrid(theta, phi, indexing="ij"), axis=-1).reshape(-1, 2)
        waits, goes = ends[:, other]
        up, down = (np.stack(np.broadcast_arrays(theta, end), axis=1) for end in ends[:, own[1]])
        pairs = [
            ((start[own], waits), (places, waits)),
            ((start[own], waits), (places, goes)),
            ((places, waits), (places, goes)),
            ((up, waits), (down, waits)),
            ((up, waits), (down, goes)),
            ((up, goes), (down, goes)),
        ]
        middles += [_poses(own + other, *pair) for pair in pairs]
    return _between(start_deg, np.concatenate(middles), goal_deg)


def leg_seconds(poses_deg: Array, rig: Rig) -> Array:
    """Return the seconds of each leg of ways through poses, shape (..., k, 4), as (..., k - 1)."""
    steps = np.diff(poses_deg, axis=-2)
    times = [move_time(steps[..., i], rig.axis[name]) for i, name in enumerate(AXES)]
    return np.asarray(np.max(times, axis=0))


def with_approach(poses_deg: Array, rig: Rig) -> Array:
    """Put in where axes that come to the last pose from one side go before, (..., k + 1, 4).

    See `gonio.approach.first_stop_deg`.
    """
    before, goal = poses_deg[..., -2, :], poses_deg[..., -1, :]
    starts = [
        first_stop_deg(before[..., i], goal[..., i], rig.axis[name]) for i, name in enumerate(AXES)
    ]
    approach = np.stack(starts, axis=-1)[..., None, :]
    return np.concatenate([poses_deg[..., :-1, :], approach, goal[..., None, :]], axis=-2)


def turned_round(goal_deg: Array, rig: Rig) -> Iterator[Array]:
    """Give poses with the same directions, other azimuths a turn away, as far as travel allows."""
    for view in (0.0, -360.0, 360.0):
        for light in (0.0, -360.0, 360.0):
            pose = goal_deg + np.array([0.0, view, 0.0, light])
            if (view or light) and (_within_travel(pose, rig) == pose).all():
                yield pose


def axis_stops(name: str, rig: Rig) -> Array:
    """Return angles in degrees over an axis' travel at which it may get out of the way."""
    axis = rig.axis[name]
    stops = np.linspace(axis.min_deg, axis.max_deg, _STOPS[name.partition("_")[2]])
    # at the pole an arm turns without going anywhere
    return np.unique([*stops, 0.0]) if axis.min_deg <= 0.0 <= axis.max_deg else stops


def _stops(column: int, ends: Array, goal: Array, rig: Rig) -> Array:
    """Return the angles at which an axis may stop on its way, those of `ends` among them."""
    axis = rig.axis[AXES[column]]
    stops = axis_stops(AXES[column], rig)
    if axis.approach_deg:
        stops = stops[np.abs(stops - goal[column]) > axis.in_position_deg]
    return np.unique([*ends[:, column], *stops])


def _poses(columns: list[int], first: tuple[Array, Array], second: tuple[Array, Array]) -> Array:
    """Return two poses to pass, shape (n, 2, 4), from the angles of one arm and of the other."""
    poses = np.empty((len(second[0]), 2, 4))
    for place, angles in enumerate((first, second)):
        poses[:, place, columns[:2]], poses[:, place, columns[2:]] = angles
    return poses


def _between(start: Array, middles: Array, goal: Array) -> Array:
    ends = [np.broadcast_to(pose, (len(middles), 1, 4)) for pose in (start, goal)]
    return np.concatenate([ends[0], middles, ends[1]], axis=1)


def _within_travel(pose: Array, rig: Rig) -> Array:
    axes = [rig.axis[name] for name in AXES]
    return np.clip(pose, [axis.min_deg for axis in axes], [axis.max_deg for axis in axes])
