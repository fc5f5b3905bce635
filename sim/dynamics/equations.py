"""The equations of motion: a matrix for each mode, and what is not linear."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from sim.dynamics.state import (
    CURRENT,
    DEMAND,
    DEMAND_SPEED,
    LOAD,
    LOAD_SPEED,
    LOST,
    MOTOR,
    MOTOR_SPEED,
    SIZE,
    WARMTH,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sim.dynamics.modes import Mode
    from sim.dynamics.parameters import AxisParameters


def linear_part(axis: AxisParameters, mode: Mode) -> NDArray[np.float64]:
    """Return the matrix L of x' = L x + n in a mode, shape (9, 9)."""
    matrix = np.zeros((SIZE, SIZE))
    matrix[CURRENT, CURRENT] = -axis.resistance_ohm
    matrix[CURRENT, MOTOR_SPEED] = -axis.torque_constant
    matrix[CURRENT] = (matrix[CURRENT] + _voltage_row(axis)) / axis.inductance_h
    matrix[LOAD, LOAD_SPEED] = matrix[DEMAND, DEMAND_SPEED] = 1.0
    matrix[LOAD_SPEED, LOAD_SPEED] = -axis.bearing / axis.load_inertia
    if mode.slides:
        matrix[MOTOR, MOTOR_SPEED] = 1.0
        matrix[MOTOR_SPEED, CURRENT] = axis.torque_constant / axis.motor_inertia
        matrix[MOTOR_SPEED, MOTOR_SPEED] = -axis.viscous / axis.motor_inertia
    if mode.flank:
        row = _coupling_row(axis)
        matrix[LOAD_SPEED] += row / axis.load_inertia
        if mode.slides:
            matrix[MOTOR_SPEED] -= row / axis.motor_inertia
    if mode.stop:
        matrix[LOAD_SPEED, LOAD] -= axis.stop_stiffness / axis.load_inertia
        matrix[LOAD_SPEED, LOAD_SPEED] -= axis.stop_damping / axis.load_inertia
    matrix[WARMTH, WARMTH] = -1.0 / axis.thermal_s
    return matrix


def remainder(
    state: Sequence[float], mode: Mode, axis: AxisParameters, acceleration: float
) -> NDArray[np.float64]:
    """Return n of x' = L x + n, shape (9,).

    Friction is Coulomb's with the peak at rest that Stribeck found (Armstrong-Helouvry et al.,
    A survey of models for the control of machines with friction, Automatica 30, 1994).

    Parameters
    ----------
    state, mode, axis
        Of an axis.
    acceleration
        That is asked for, rad/s2.
    """
    rest = np.zeros(SIZE)
    offset = 0.5 * axis.stiffness * mode.flank * axis.play_rad
    friction = friction_nm(state[MOTOR_SPEED], mode, axis)
    if mode.slides:
        rest[MOTOR_SPEED] = (offset - friction) / axis.motor_inertia
    pull = axis.gravity_nm * math.sin(state[LOAD]) - offset
    if mode.stop:
        pull += axis.stop_stiffness * (axis.high_rad if mode.stop > 0 else axis.low_rad)
    rest[LOAD_SPEED] = pull / axis.load_inertia
    copper_w = axis.resistance_ohm * state[CURRENT] ** 2
    rest[WARMTH] = copper_w / axis.heat_capacity
    lost_w = copper_w + friction * state[MOTOR_SPEED] + _damped_w(state, mode, axis)
    rest[LOST] = lost_w - volts(state, axis) * state[CURRENT]
    rest[DEMAND_SPEED] = acceleration
    return rest


def friction_nm(speed: float, mode: Mode, axis: AxisParameters) -> float:
    """Return the friction of a motor that slides, without its viscous part."""
    if not (mode.slides and axis.static_nm):
        return 0.0
    peak = (axis.static_nm - axis.coulomb_nm) * math.exp(-((speed / axis.stribeck_rad_s) ** 2))
    return mode.slides * (axis.coulomb_nm + peak)


def volts(state: Sequence[float], axis: AxisParameters) -> float:
    """Return what the servo puts on the motor; the speed asked for is fed forward."""
    return (
        axis.position_gain * (state[DEMAND] - state[MOTOR])
        + axis.velocity_gain * (state[DEMAND_SPEED] - state[MOTOR_SPEED])
        + axis.torque_constant * state[DEMAND_SPEED]
    )


def energy_j(state: Sequence[float], mode: Mode, axis: AxisParameters) -> float:
    """Return what is stored in winding, inertias, bent arm, stop and height."""
    stored = 0.5 * axis.inductance_h * state[CURRENT] ** 2
    stored += 0.5 * axis.motor_inertia * state[MOTOR_SPEED] ** 2
    stored += 0.5 * axis.load_inertia * state[LOAD_SPEED] ** 2
    stored += axis.gravity_nm * math.cos(state[LOAD])
    if mode.flank:
        bent = state[MOTOR] - state[LOAD] - 0.5 * mode.flank * axis.play_rad
        stored += 0.5 * axis.stiffness * bent**2
    if mode.stop:
        pressed = state[LOAD] - (axis.high_rad if mode.stop > 0 else axis.low_rad)
        stored += 0.5 * axis.stop_stiffness * pressed**2
    return stored


def _voltage_row(axis: AxisParameters) -> NDArray[np.float64]:
    row = np.zeros(SIZE)
    row[DEMAND], row[MOTOR] = axis.position_gain, -axis.position_gain
    row[DEMAND_SPEED] = axis.velocity_gain + axis.torque_constant
    row[MOTOR_SPEED] = -axis.velocity_gain
    return row


def _coupling_row(axis: AxisParameters) -> NDArray[np.float64]:
    row = np.zeros(SIZE)
    row[MOTOR], row[LOAD] = axis.stiffness, -axis.stiffness
    row[MOTOR_SPEED], row[LOAD_SPEED] = axis.damping, -axis.damping
    return row


def _damped_w(state: Sequence[float], mode: Mode, axis: AxisParameters) -> float:
    motor, load = state[MOTOR_SPEED], state[LOAD_SPEED]
    power = axis.viscous * motor**2 + axis.bearing * load**2
    if mode.flank:
        power += axis.damping * (motor - load) ** 2
    if mode.stop:
        power += axis.stop_damping * load**2
    return power
