"""How long a rig takes: moves, settling, a whole capture."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gonio.approach import first_stop_deg
from gonio.eta import Budget
from gonio.homing import homing_time
from gonio.plan import Estimates
from gonio.profile import s_curve_s, trapezoid_s
from gonio.rig import AXES, Axis
from gonio.timing import AxisTiming, default_timing

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import ArrayLike, NDArray

    from gonio.plan import Shot
    from gonio.rig import Rig
    from gonio.timing import Timing

    Array = NDArray[np.float64]

FRAME_HEADER_BYTES = 1024

DARK_FRAMES = 4
WHITE_FRAMES = 4
"""Dark and white frames taken of each exposure."""

WHITE_POSE_DEG = {"light_theta": 0.0, "light_phi": 0.0, "view_theta": 45.0, "view_phi": 0.0}
"""Where the white reference is taken: 0:45, light along the normal, view at 45 deg (CIE 15)."""


def move_time(distance_deg: ArrayLike, axis: Axis | AxisTiming) -> Array:
    """Return the seconds of a move from rest until it is known to be in position; 0 for no move.

    Parameters
    ----------
    distance_deg
        In degrees, either way, any shape.
    axis
        How the axis acts. One of a rig file counts as acting just so: a trapezoid, no latency.
    """
    acts = AxisTiming.nominal(axis) if isinstance(axis, Axis) else axis
    distance = np.abs(np.asarray(distance_deg, np.float64))
    limits = (acts.velocity_deg_s, acts.acceleration_deg_s2)
    if acts.jerk_deg_s3:
        profile = s_curve_s(distance, *limits, acts.jerk_deg_s3)
    else:
        profile = trapezoid_s(distance, *limits)
    return np.where(distance > 0, acts.latency_s + profile, 0.0)


def pose_angles_deg(shots: Sequence[Shot]) -> Array:
    """Return the four axes' angles of each shot in degrees, shape (n, 4), in the order of AXES."""
    return np.array([[shot.axis_deg(name) for name in AXES] for shot in shots], dtype=np.float64)


def route_times(angles_deg: Array, rig: Rig, timing: Timing | None = None) -> Array:
    """Return the seconds of each move along a route until the axes, moving together, are there.

    Axes that are approached from one side (`approach_deg`) go to where their run-up begins, and
    when all have arrived make that together.

    Parameters
    ----------
    angles_deg
        Shape (n, 4), as from `pose_angles_deg`.
    rig
        The rig.
    timing
        How it acts; without it, just as its rig file says.

    Returns
    -------
    ndarray
        Shape (n - 1,).
    """
    return np.asarray(np.max(_arrivals(angles_deg, rig, timing), axis=0))


def _arrivals(angles_deg: Array, rig: Rig, timing: Timing | None) -> Array:
    """Return when each axis arrives in each move, shape (4, moves); 0 where it stays."""
    axes = rig.axis if timing is None else timing.axis
    starts, goals = angles_deg[:-1].T, angles_deg[1:].T
    stops = np.array(
        [first_stop_deg(starts[i], goals[i], rig.axis[name]) for i, name in enumerate(AXES)]
    )
    first, run_up = (
        np.array([move_time(ways[i], axes[name]) for i, name in enumerate(AXES)])
        for ways in (stops - starts, goals - stops)
    )
    return np.where(run_up > 0, first.max(axis=0) + run_up, first)


def still_times(angles_deg: Array, rig: Rig, timing: Timing) -> Array:
    """Return the seconds of each move along a route until both arms are still.

    Parameters
    ----------
    angles_deg
        Shape (n, 4), as from `pose_angles_deg`.
    rig, timing
        The rig, and how it acts.

    Returns
    -------
    ndarray
        Shape (n - 1,).
    """
    view_theta, view_phi, light_theta, light_phi = _settled(angles_deg, rig, timing)
    arms = ((view_theta, view_phi), (light_theta, light_phi))
    return np.asarray(np.max([_together(*axes, timing.ring_down_s) for axes in arms], axis=0))


def _settled(angles_deg: Array, rig: Rig, timing: Timing) -> Array:
    """Return until when each axis alone would shake its arm, shape (4, moves); 0 if it stays."""
    arrivals = _arrivals(angles_deg, rig, timing)
    settle_s = np.array([timing.axis[name].settle.mean_s for name in AXES])
    return np.where(arrivals > 0, arrivals + settle_s[:, None], 0.0)


def _together(one: Array, other: Array, ring_down_s: float) -> Array:
    """Return until when two axes shake their arm: vibrations add up, and fall exponentially."""
    late, early = np.maximum(one, other), np.minimum(one, other)
    if not ring_down_s:
        return late
    longer = ring_down_s * np.log1p(np.exp((early - late) / ring_down_s))
    return np.where(early > 0, late + longer, late)


def estimate(
    shots: Sequence[Shot],
    rig: Rig,
    timing: Timing | None = None,
    calibrated_s: Collection[float] = (),
    at_deg: Sequence[float] | None = None,
) -> Estimates:
    """Estimate the time and storage of a whole capture.

    From the greeting of the devices to the last frame: homing from anywhere, dark and white
    frames at 0:45, then shot by shot moving, settling, lamps, exposures and read-out, of which the
    last of a shot is overlapped by the next move.

    Parameters
    ----------
    shots
        In route order.
    rig
        The rig.
    timing
        How it acts; without it, as `gonio.timing.default_timing` expects.
    calibrated_s
        Exposures of which dark and white frames are there, in seconds.
    at_deg
        Where the axes stand, in the order of AXES, when it goes on from a capture just ended: they
        know their position then. None: they are homed first.
    """
    from gonio.legs import legs_of  # ways round are judged by the times of this module

    timing = timing or default_timing(rig)
    calibration = [e for e in calibration_exposures_s(shots) if e not in calibrated_s]
    start = [rig.axis[name].to_degrees(0) for name in AXES] if at_deg is None else at_deg
    white = [[WHITE_POSE_DEG[name] for name in AXES]][: len(calibration)]
    angles_deg, begins = legs_of(np.vstack([start, *white, pose_angles_deg(shots)]), rig)
    legs = route_times(angles_deg, rig, timing)
    moving, ends = np.add.reduceat(legs, begins), np.append(begins[1:], len(legs)) - 1
    # nobody waits until the arms are still on the way
    settling = (still_times(angles_deg, rig, timing) - legs)[ends]
    still = moving + settling
    to_shots = still[len(white) :]
    frames = sum(len(shot.exposures_s) for shot in shots) + len(calibration)
    exposing = math.fsum(math.fsum(shot.exposures_s) for shot in shots) + math.fsum(calibration)
    budget = Budget()
    budget.add_seconds(exposing)
    _add_moves(budget, _settled(angles_deg, rig, timing)[:, ends], moving, still, timing)
    # the way to the first shot begins when all white frames are in
    overlapped = np.minimum(to_shots[1:] + timing.lamps.mean_s, timing.read_out.mean_s)
    homing = budget.add(homing_time(rig, timing)) if at_deg is None else 0.0
    overhead = (
        budget.add(timing.startup)
        + budget.add(timing.lamps, len(shots))
        + budget.add(timing.hold, frames)
        + budget.add(timing.read_out, frames)
        + budget.add_seconds(-math.fsum(overlapped))
        + budget.add_seconds(_waiting_for_lamps(shots, to_shots, rig, timing))
    )
    low_s, high_s = budget.interval_s
    return Estimates(
        moving_s=float(moving.sum()),
        settling_s=float(settling.sum()),
        exposing_s=exposing,
        overhead_s=overhead,
        homing_s=homing,
        total_lo_s=low_s,
        total_hi_s=high_s,
        timing_sha256=timing.sha256 if timing.measured else None,
        frames=frames,
        storage_bytes=frames * frame_bytes(rig),
    )


def _waiting_for_lamps(shots: Sequence[Shot], still: Array, rig: Rig, timing: Timing) -> float:
    """Return the seconds of warming up and of resting, as `gonio.capture` waits for them."""
    lamps = rig.lamps
    if not lamps.rest_s:
        return lamps.warm_up_s
    frame_s = timing.hold.mean_s + timing.read_out.mean_s
    white = WHITE_FRAMES * exposures_of(shots)
    waited_s = lamps.warm_up_s
    lit_s = lamps.warm_up_s + math.fsum(white) + frame_s * len(white)
    for shot, move_s in zip(shots, still, strict=True):
        lit_s += move_s
        if lit_s >= lamps.rest_after_s:
            lit_s, waited_s = lamps.warm_up_s, waited_s + lamps.rest_s + lamps.warm_up_s
        lit_s += timing.lamps.mean_s + math.fsum(shot.exposures_s)
        lit_s += frame_s * len(shot.exposures_s)
    return waited_s


def _add_moves(budget: Budget, settled: Array, moving: Array, still: Array, timing: Timing) -> None:
    """Add the moves of a route, each as sure as the axis that it waits for."""
    axes = [timing.axis[name] for name in AXES]
    last = np.argmax(settled, axis=0)
    moved = still > 0
    variance_s2 = np.array([axis.sd_s**2 + axis.settle.sd_s**2 for axis in axes])[last]
    speed, settle_s = np.array([(axis.error, axis.settle.error_s) for axis in axes]).T[:, last]
    common_s = speed * moving + settle_s * moved
    budget.add_seconds(float(still.sum()), float(variance_s2[moved].sum()), float(common_s.sum()))


def exposures_of(shots: Sequence[Shot]) -> list[float]:
    """Return the distinct exposures of `shots` in seconds, from short to long."""
    return sorted({exposure for shot in shots for exposure in shot.exposures_s})


def calibration_exposures_s(shots: Sequence[Shot]) -> list[float]:
    """Return the exposures of the dark and white frames that precede a capture of `shots`."""
    return (DARK_FRAMES + WHITE_FRAMES) * exposures_of(shots)


def frame_bytes(rig: Rig) -> int:
    """Return the bytes of a raw frame, 16 bits a pixel."""
    return 2 * rig.camera.width * rig.camera.height + FRAME_HEADER_BYTES
