"""How long a rig takes: moves, settling, exposures."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gonio.plan import Estimates
from gonio.rig import AXES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from gonio.plan import Shot
    from gonio.rig import Axis, Rig

SETTLE_S = 1.0
"""Expected wait after a move until the arm is still (the twin's rings down in about that)."""

FRAME_OVERHEAD_S = 0.1
"""Expected trigger, read-out and file time of a frame beyond its exposure."""

FRAME_HEADER_BYTES = 1024
HOMING_S = 30.0

DARK_FRAMES = 4
WHITE_FRAMES = 4
"""Dark and white frames taken of each exposure."""


def move_time(distance_deg: ArrayLike, axis: Axis) -> NDArray[np.float64]:
    """Return the seconds of a trapezoid (or triangle) profile, from rest to rest."""
    distance = np.abs(np.asarray(distance_deg, np.float64))
    speed, acceleration = axis.max_velocity_deg_s, axis.max_acceleration_deg_s2
    ramps = speed * speed / acceleration
    triangle = 2.0 * np.sqrt(distance / acceleration)
    trapezoid = distance / speed + speed / acceleration
    return np.where(distance < ramps, triangle, trapezoid)


def approach_start_deg(
    start_deg: ArrayLike, goal_deg: ArrayLike, axis: Axis
) -> NDArray[np.float64]:
    """Return where an axis goes before its goal, so that it comes to it from the one side.

    That is `approach_deg` before the goal, as far as the travel allows; the goal itself where
    there is nothing to take up: no such approach, an axis that stays, or a way from the right side
    that is long enough.
    """
    start, goal = np.asarray(start_deg, np.float64), np.asarray(goal_deg, np.float64)
    run_up, way = axis.approach_deg, goal - start
    if not run_up:
        return goal
    short = (np.abs(way) > axis.in_position_deg) & (way / run_up < 1.0)
    return np.where(short, np.clip(goal - run_up, axis.min_deg, axis.max_deg), goal)


def pose_angles_deg(shots: Sequence[Shot]) -> NDArray[np.float64]:
    """Return the four axes' angles of each shot in degrees, shape (n, 4), in the order of AXES."""
    return np.array([[shot.axis_deg(name) for name in AXES] for shot in shots], dtype=np.float64)


def route_times(angles_deg: NDArray[np.float64], rig: Rig) -> NDArray[np.float64]:
    """Return the seconds of each move along a route, the axes moving together.

    Parameters
    ----------
    angles_deg
        Shape (n, 4), as from `pose_angles_deg`.

    Returns
    -------
    ndarray
        Shape (n - 1,).
    """
    steps = np.diff(angles_deg, axis=0)
    times = [move_time(steps[:, i], rig.axis[name]) for i, name in enumerate(AXES)]
    return np.asarray(np.max(times, axis=0))


def estimate(shots: Sequence[Shot], rig: Rig) -> Estimates:
    """Estimate the time and storage of a capture, homing and calibration frames included."""
    moves = route_times(pose_angles_deg(shots), rig)
    calibration = calibration_exposures_s(shots)
    frames = sum(len(shot.exposures_s) for shot in shots) + len(calibration)
    exposing = math.fsum(math.fsum(shot.exposures_s) for shot in shots)
    return Estimates(
        moving_s=float(moves.sum()),
        settling_s=SETTLE_S * int(np.count_nonzero(moves)),
        exposing_s=exposing + math.fsum(calibration),
        overhead_s=HOMING_S + FRAME_OVERHEAD_S * frames,
        frames=frames,
        storage_bytes=frames * frame_bytes(rig),
    )


def exposures_of(shots: Sequence[Shot]) -> list[float]:
    """Return the distinct exposures of `shots` in seconds, from short to long."""
    return sorted({exposure for shot in shots for exposure in shot.exposures_s})


def calibration_exposures_s(shots: Sequence[Shot]) -> list[float]:
    """Return the exposures of the dark and white frames that precede a capture of `shots`."""
    return (DARK_FRAMES + WHITE_FRAMES) * exposures_of(shots)


def frame_bytes(rig: Rig) -> int:
    """Return the bytes of a raw frame, 16 bits a pixel."""
    return 2 * rig.camera.width * rig.camera.height + FRAME_HEADER_BYTES
