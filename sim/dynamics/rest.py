"""Whether an axis that friction holds can ever move again by itself."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from sim.dynamics.equations import volts
from sim.dynamics.state import CURRENT, DEMAND_SPEED, LOAD, LOAD_SPEED, MOTOR

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sim.dynamics.modes import Mode
    from sim.dynamics.parameters import AxisParameters


def is_quiet(state: Sequence[float], mode: Mode, axis: AxisParameters, acceleration: float) -> bool:
    """Return whether nothing can end the mode while the demand stands still.

    With the motor held the energy of the load's swing only falls, so the swing's torque keeps
    below sqrt(2 k E), and the current goes straight to volts / resistance.
    """
    if mode.slides or mode.stop or not mode.flank or acceleration or state[DEMAND_SPEED]:
        return False
    bent = state[MOTOR] - state[LOAD] - 0.5 * mode.flank * axis.play_rad
    weight = axis.gravity_nm * math.sin(state[LOAD])
    # off balance by this; the pull changes with the angle, but less than the spring by far
    off = axis.stiffness * bent + weight
    swing = math.hypot(off, math.sqrt(axis.stiffness * axis.load_inertia) * state[LOAD_SPEED])
    swing *= 1.0 + 2.0 * axis.gravity_nm / axis.stiffness
    settled = axis.torque_constant * volts(state, axis) / axis.resistance_ohm
    push = max(abs(settled + weight), abs(axis.torque_constant * state[CURRENT] + weight))
    clear = min(axis.high_rad - state[LOAD], state[LOAD] - axis.low_rad)
    return (
        push + swing < axis.static_nm
        and (swing < abs(weight) or not axis.play_rad)
        and swing < axis.stiffness * clear
    )
