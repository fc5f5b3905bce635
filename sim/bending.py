"""Where an arm's end truly is, beyond what any encoder sees: its weight, its warmth, its swing."""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING

import numpy as np

from sim.flexible_arm import FlexibleArm

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sim.arm_imperfections import ArmImperfections
    from sim.vibration import Vibration

_DAY_S = 86400.0
_LOOKS = 16
# of a cantilever with its load at the end, the slope turns the view, and the end moves along with
# two thirds of it, so that a third is left to move the picture (Euler and Bernoulli)
_SEEN_SHARE = 1.0 / 3.0


def bent_deg(
    theta_deg: float, phi_deg: float, now: float, by: ArmImperfections
) -> tuple[float, float]:
    """Return the angles of an arm's end, for those of its joints.

    Parameters
    ----------
    theta_deg, phi_deg
        Of the joints.
    now
        Seconds since the drives were switched on.
    by
        What bends it.
    """
    turned_deg = math.degrees(1e-6 * by.arm_expansion_urad_k * warming_k(now, by))
    sag_deg = math.degrees(1e-6 * by.arm_sag_urad * math.sin(math.radians(theta_deg)))
    return theta_deg + sag_deg + turned_deg, phi_deg + turned_deg


def warming_k(now: float, by: ArmImperfections) -> float:
    """Return how much warmer the arm is than at power-up in a room of even temperature.

    It follows the room's swing over a day, and its own heat, with one time constant.
    """
    day = 2j * math.pi / _DAY_S
    room = by.arm_room_k * (cmath.exp(day * now) / (1.0 + day * by.arm_thermal_s)).imag
    return room - by.arm_warm_up_k * math.expm1(-now / by.arm_thermal_s)


def shake_rad(
    arm: str, theta: float, vibration: Vibration, now: float, exposure_s: float
) -> NDArray[np.float64] | None:
    """Return how far the picture is off while the shutter is open; None where nothing swings.

    Parameters
    ----------
    arm
        Of the camera.
    theta
        Where it stands, rad: near the pole its azimuth moves the end little.
    vibration
        The arm's.
    now, exposure_s
        When the shutter opens, and for how long.

    Returns
    -------
    NDArray[np.float64] | None
        Along the picture's rows' and columns' numbers, rad, shape (16, 2).
    """
    if not isinstance(vibration, FlexibleArm):
        return None
    times = now + exposure_s * (np.arange(_LOOKS) + 0.5) / _LOOKS
    along = vibration.deflection_rad(f"{arm}_theta", times)
    across = math.sin(theta) * vibration.deflection_rad(f"{arm}_phi", times)
    return _SEEN_SHARE * np.stack([along, across], axis=1)
