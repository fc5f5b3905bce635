"""What an axis is made of, in SI units, all on the arm's side of the gear."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class AxisParameters:
    """One axis: a servo motor behind a gear with play, and an arm that bends.

    The defaults are those of a 2 m arm with a mechanical time constant of 0.1 s.

    Attributes
    ----------
    inductance_h, resistance_ohm
        Of the winding.
    torque_constant
        Of the motor times the gear ratio, N m/A; also that of the back-EMF, V s/rad.
    motor_inertia, load_inertia
        Of rotor and gear, and of the arm with what it carries, kg m2.
    stiffness, damping
        Of the arm between gear and load, N m/rad and N m s/rad.
    play_rad
        Backlash of the gear, from flank to flank.
    coulomb_nm, static_nm, stribeck_rad_s
        Friction at the motor: sliding, at rest, and the speed over which it falls between them.
    viscous, bearing
        Friction in proportion to speed, at the motor and at the load, N m s/rad.
    gravity_nm
        Weight times lever of the load; it pulls away from the vertical by its sine.
    low_rad, high_rad, stop_stiffness, stop_damping
        The end stops.
    heat_capacity, thermal_s, expansion_rad_k
        Of the arm beside its motor: J/K, the time constant, and how far it turns the arm's end.
    position_gain, velocity_gain
        Of the servo, V/rad and V s/rad; both 0 where nothing drives the motor.
    """

    inductance_h: float = 9.09e-5
    resistance_ohm: float = 0.909
    torque_constant: float = 10.0
    motor_inertia: float = 1.0
    load_inertia: float = 10.0
    stiffness: float = 9870.0
    damping: float = 6.28
    play_rad: float = 2e-4
    coulomb_nm: float = 5.0
    static_nm: float = 8.0
    stribeck_rad_s: float = 0.01
    viscous: float = 2.0
    bearing: float = 0.1
    gravity_nm: float = 20.0
    low_rad: float = -0.02
    high_rad: float = 1.6
    stop_stiffness: float = 1e6
    stop_damping: float = 1e3
    heat_capacity: float = 500.0
    thermal_s: float = 1e3
    expansion_rad_k: float = 5e-6
    position_gain: float = 1e4
    velocity_gain: float = 130.0

    @property
    def electrical_s(self) -> float:
        """Time constant of the winding's current."""
        return self.inductance_h / self.resistance_ohm

    @property
    def mechanical_s(self) -> float:
        """Time constant of the speed at a constant voltage, as motors' data sheets give it."""
        inertia = self.motor_inertia + self.load_inertia
        return inertia * self.resistance_ohm / self.torque_constant**2

    @property
    def resonance_hz(self) -> float:
        """Frequency of the arm with its motor held."""
        return math.sqrt(self.stiffness / self.load_inertia) / (2.0 * math.pi)


STICKY = replace(AxisParameters(), stribeck_rad_s=1e-3, position_gain=1e3, velocity_gain=0.0)
"""A servo so soft, and a friction that falls so steeply, that the motor sticks and slips."""
