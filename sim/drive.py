"""One axis' drive as its unit on the bus: the objects behind the registers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from sim.control import DriveControl
from sim.positioning import SetPoint
from sim.registers import check_write, read_span

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from gonio.rig import Axis
    from sim.fittings import Fittings

# velocity and acceleration at reset are the drive's own
_RESET_SHARE = 0.25


class Drive:
    """Answers for one unit; whoever asks says what time it is.

    Parameters
    ----------
    spec
        The axis in the rig file.
    fittings
        What it is fitted with beside its motor.
    position
        Where it stands at power-up, in counts from the home switch's edge.
    now
        When it is switched on.

    Attributes
    ----------
    control
        What the drive does; its `trip` is for whoever wants a fault.
    axis, homing
        The control's own.
    target
        The target position register, in counts.
    """

    def __init__(self, spec: Axis, fittings: Fittings, position: float, now: float) -> None:
        self.control = control = DriveControl(spec, fittings, position)
        self.axis, self.homing = control.axis, control.homing
        self._max_velocity = math.ceil(spec.max_velocity_deg_s * self.axis.counts_per_deg)
        self._max_acceleration = math.ceil(spec.max_acceleration_deg_s2 * self.axis.counts_per_deg)
        self._read: dict[str, Callable[[float], int]] = {
            "controlword": lambda _: self._controlword,
            "statusword": control.statusword,
            "mode": lambda _: control.mode,
            "mode_display": lambda _: control.mode_display,
            "target_position": lambda _: self.target,
            "position_actual": self.axis.encoder,
            "profile_velocity": lambda _: self._velocity,
            "profile_acceleration": lambda _: self._acceleration,
            "following_error": self.axis.following_error,
            "error_code": lambda _: control.error,
            "digital_inputs": control.inputs,
            "watchdog_ms": lambda _: control.watchdog_ms,
            "settle_urad": fittings.vibration.settle_urad,
        }
        self._write: dict[str, Callable[[int, float], None]] = {
            "controlword": self._set_controlword,
            "mode": lambda value, _: control.set_mode(value),
            "target_position": self._set_target,
            "profile_velocity": self._set_velocity,
            "profile_acceleration": self._set_acceleration,
            "watchdog_ms": self._set_watchdog,
        }
        self.power_up(now)

    def power_up(self, now: float) -> None:
        """Be switched off and on: registers at reset, position lost."""
        self._controlword = self.target = 0
        self._velocity = math.ceil(_RESET_SHARE * self._max_velocity)
        self._acceleration = math.ceil(_RESET_SHARE * self._max_acceleration)
        self.control.power_up(now)

    def read(self, address: int, count: int, now: float) -> list[int]:
        """Answer function 3.

        Raises
        ------
        sim.registers.RefusedError
            With the exception's code.
        """
        self.control.advance(now)
        words = [
            (self._read[name](now) >> shift) & 0xFFFF for name, shift in read_span(address, count)
        ]
        self.control.asked_s = now
        return words

    def write(self, address: int, values: Sequence[int], now: float) -> None:
        """Answer functions 6 and 16 (errors as for `read`)."""
        self.control.advance(now)
        for name, value in check_write(address, values):
            self._write[name](value, now)
        self.control.asked_s = now
        self.control.advance(now)

    def _set_controlword(self, word: int, now: float) -> None:
        rising = word & ~self._controlword
        self._controlword = word
        point = SetPoint(self.target, self._velocity, self._acceleration)
        self.control.command(word, rising, point, now)

    def _set_target(self, value: int, _: float) -> None:
        self.target = value

    def _set_velocity(self, value: int, _: float) -> None:
        self._velocity = min(value, self._max_velocity)

    def _set_acceleration(self, value: int, _: float) -> None:
        self._acceleration = value

    def _set_watchdog(self, value: int, _: float) -> None:
        self.control.watchdog_ms = value
