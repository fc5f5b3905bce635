"""Which of its pieces of linear motion an axis is on, and what ends each."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from sim.dynamics.state import CURRENT, LOAD, LOAD_SPEED, MOTOR, MOTOR_SPEED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sim.dynamics.parameters import AxisParameters


class Mode(NamedTuple):
    """One piece.

    Attributes
    ----------
    slides
        Direction in which the motor slides; 0 where friction holds it.
    flank
        Which flank of the gear drives: 1 the one that pushes the load up, -1 the other, 0 none.
    stop
        Which end stop the load is at: 1 the high one, -1 the low one, 0 none.
    """

    slides: int
    flank: int
    stop: int


def mode_of(state: Sequence[float], axis: AxisParameters) -> Mode:
    """Return the mode of a state."""
    twist, load, speed = state[MOTOR] - state[LOAD], state[LOAD], state[MOTOR_SPEED]
    half = 0.5 * axis.play_rad
    flank = (twist >= half) - (twist < -half) if axis.play_rad else 1
    stop = (load >= axis.high_rad) - (load < axis.low_rad)
    mode = Mode((speed > 0) - (speed < 0), flank, stop)
    return mode if mode.slides else _at_rest(state, mode, axis)


def margins(state: Sequence[float], mode: Mode, axis: AxisParameters) -> tuple[float, ...]:
    """Return how far a state is from what ends its mode; the first below zero ends it.

    The margins are of friction, of the gear's upper and lower flank and of the upper and lower
    stop, in rad/s or N m, and rad.
    """
    twist, load = state[MOTOR] - state[LOAD], state[LOAD]
    half = 0.5 * axis.play_rad
    if not axis.static_nm:
        friction = math.inf
    elif mode.slides:
        friction = mode.slides * state[MOTOR_SPEED]
    else:
        friction = axis.static_nm - abs(push_nm(state, mode, axis))
    if axis.play_rad:
        upper = twist - half if mode.flank > 0 else half - twist
        lower = -half - twist if mode.flank < 0 else twist + half
    else:
        upper = lower = math.inf
    return (
        friction,
        upper,
        lower,
        load - axis.high_rad if mode.stop > 0 else axis.high_rad - load,
        axis.low_rad - load if mode.stop < 0 else load - axis.low_rad,
    )


def next_mode(state: Sequence[float], mode: Mode, which: int, axis: AxisParameters) -> Mode:
    """Return the mode after margin number `which` fell below zero."""
    if which == 0 and not mode.slides:
        return mode._replace(slides=1 if push_nm(state, mode, axis) > 0 else -1)
    if which == 0:
        return _at_rest(state, mode, axis)
    if which in (1, 2):
        side = 3 - 2 * which
        return mode._replace(flank=0 if mode.flank == side else side)
    side = 7 - 2 * which
    return mode._replace(stop=0 if mode.stop == side else side)


def push_nm(state: Sequence[float], mode: Mode, axis: AxisParameters) -> float:
    """Return the torque that friction has to hold at the motor."""
    return axis.torque_constant * state[CURRENT] - coupling_nm(state, mode, axis)


def coupling_nm(state: Sequence[float], mode: Mode, axis: AxisParameters) -> float:
    """Return the torque that the gear passes on to the load."""
    if not mode.flank:
        return 0.0
    bent = state[MOTOR] - state[LOAD] - 0.5 * mode.flank * axis.play_rad
    return axis.stiffness * bent + axis.damping * (state[MOTOR_SPEED] - state[LOAD_SPEED])


def _at_rest(state: Sequence[float], mode: Mode, axis: AxisParameters) -> Mode:
    """Return whether the motor, at rest for a moment, sticks, or which way it slides."""
    push = push_nm(state, mode, axis)
    if abs(push) <= axis.static_nm and axis.static_nm > 0:
        return mode._replace(slides=0)
    return mode._replace(slides=1 if push > 0 else -1)
