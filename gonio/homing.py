"""How long homing takes when nobody knows where the axes stand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.rig import AXES
from gonio.timing import Spread

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import Axis, Rig
    from gonio.timing import AxisTiming, Timing

    Array = NDArray[np.float64]

_STEPS = 4000


def homing_time(rig: Rig, timing: Timing) -> Spread:
    """Return the time until all axes are home, each from anywhere in its travel alike.

    They home at once, so it is that of the latest: its distribution is the product of theirs, and
    its moments are integrals of what that leaves to one.
    """
    latest_s = longest_homing_s(rig, timing)
    time_s = np.linspace(0.0, latest_s, _STEPS)
    shares = [_share_home(time_s, rig.axis[name], timing.axis[name]) for name in AXES]
    left = 1.0 - np.prod(shares, axis=0)
    mean_s = float(np.trapezoid(left, time_s))
    square_s2 = float(np.trapezoid(2.0 * time_s * left, time_s))
    return Spread(mean_s=mean_s, sd_s=max(square_s2 - mean_s * mean_s, 0.0) ** 0.5)


def longest_homing_s(rig: Rig, timing: Timing) -> float:
    """Return the seconds until all axes are home where each begins at its farther end."""
    return max(_longest(rig.axis[name], timing.axis[name]) for name in AXES)


def _longest(spec: Axis, axis: AxisTiming) -> float:
    switch = spec.to_degrees(0)
    way = max(abs(spec.min_deg - switch), abs(spec.max_deg - switch))
    return axis.homing_s + way / axis.homing_velocity_deg_s


def _share_home(time_s: Array, spec: Axis, axis: AxisTiming) -> Array:
    """Return from which share of its travel an axis is home by then, shape as given."""
    switch = spec.to_degrees(0)
    way = (time_s - axis.homing_s) * axis.homing_velocity_deg_s
    low, high = np.maximum(switch - way, spec.min_deg), np.minimum(switch + way, spec.max_deg)
    share = np.clip((high - low) / (spec.max_deg - spec.min_deg), 0.0, 1.0)
    return np.where(way < 0, 0.0, share)
