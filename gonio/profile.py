"""How long a motion from rest to rest takes under limits of velocity, acceleration and jerk."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


def trapezoid_s(distance: Array, velocity: float, acceleration: float) -> Array:
    """Return the seconds of a trapezoid, or of a triangle that never reaches `velocity`.

    Parameters
    ----------
    distance
        In any unit u, not negative, any shape.
    velocity, acceleration
        In u/s and u/s2.
    """
    triangle = 2.0 * np.sqrt(distance / acceleration)
    full = distance / velocity + velocity / acceleration
    return np.where(distance < velocity * velocity / acceleration, triangle, full)


def s_curve_s(distance: Array, velocity: float, acceleration: float, jerk: float) -> Array:
    """Return the seconds of an S-curve (double S, Biagiotti and Melchiorri 2008, section 3.4).

    Parameters
    ----------
    distance
        In any unit u, not negative, any shape.
    velocity, acceleration, jerk
        In u/s, u/s2 and u/s3.
    """
    onset = acceleration / jerk
    # the ramp up to full velocity, which may be too short to reach full acceleration
    if onset * acceleration < velocity:
        ramp = velocity / acceleration + onset
    else:
        ramp = 2.0 * math.sqrt(velocity / jerk)
    full = distance / velocity + ramp
    # no full velocity: with full acceleration, or without that, too
    sharp = onset + np.sqrt(onset * onset + 4.0 * distance / acceleration)
    soft = 4.0 * np.cbrt(0.5 * distance / jerk)
    short = np.where(distance < 2.0 * acceleration * onset * onset, soft, sharp)
    return np.where(distance < velocity * ramp, short, full)
