"""One axis of the arm: how it is homed and moved, and when it has arrived."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gonio.devices.drive import IDLE_WATCHDOG_MS, Drive
from gonio.devices.states import (
    ACKNOWLEDGED,
    ENABLE_OPERATION,
    FOLLOWING_ERROR,
    HOMING,
    HOMING_ATTAINED,
    HOMING_ERROR,
    LIMIT_ACTIVE,
    PROFILE_POSITION,
    START,
    TARGET_REACHED,
)
from gonio.errors import DeviceFaultError
from gonio.timemodel import move_time

if TYPE_CHECKING:
    from gonio.clock import Clock
    from gonio.devices.registers import DriveRegisters
    from gonio.devices.troubles import Troubles
    from gonio.rig import Axis

# a drive that is asked nothing for so long while it moves stops by itself: the host is gone
_WATCHDOG_MS = 3000
_READINGS = 3


class AxisDrive(Drive):
    """A drive that homes its axis and moves it (parameters as for `Drive` and `Arm`).

    Attributes
    ----------
    homed
        Whether the drive has said that it knows its position.
    """

    def __init__(
        self, name: str, spec: Axis, registers: DriveRegisters, clock: Clock, troubles: Troubles
    ) -> None:
        super().__init__(name, spec, registers, clock)
        self._troubles = troubles
        self.homed = False
        self._target_deg = math.nan

    def settle_urad(self) -> int:
        """Return the residual vibration of the axis' arm."""
        return self._registers.read("settle_urad")

    def resting_degrees(self) -> float:
        """Return the angle by the encoder; what is not where the axis was sent is read again."""
        angle = self.degrees()
        for _ in range(_READINGS):
            off = abs(angle - self._target_deg)
            # without a target there is nothing to compare with
            if not off > self.spec.in_position_deg:
                break
            before, angle = angle, self.degrees()
            if abs(angle - self._target_deg) <= self.spec.in_position_deg:
                what = f"{self.name}: a reading of {before:.2f} deg where {angle:.2f} deg is"
                self._troubles.note(what, "read again")
        return angle

    def begin_homing(self, *, anew: bool = False) -> bool:
        """Start homing, unless the position is known and not to be found anew.

        Returns whether it was started.
        """
        if self.finds_itself_homed() and not anew:
            return False
        self.homed = False
        self._set_mode(HOMING)
        self._registers.write("watchdog_ms", _WATCHDOG_MS)
        # bit 4 stays at 1 until homing is over; clearing it interrupts
        self._registers.write("controlword", START)
        return True

    def finds_itself_homed(self) -> bool:
        """Ask the drive whether it knows its position, which it tells in homing mode."""
        self._set_mode(HOMING)
        self.homed = self._knows_position()
        self._set_mode(PROFILE_POSITION)
        return self.homed

    def has_homed(self) -> bool:
        """Return whether homing is over, and go back to profile position mode when it is.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When homing failed or the drive is no longer enabled.
        """
        if self._status_in_operation() & HOMING_ERROR:
            raise self.fault("homing failed")
        self.homed = self._knows_position()
        if self.homed:
            self._registers.write("controlword", ENABLE_OPERATION)
            self._registers.write("watchdog_ms", IDLE_WATCHDOG_MS)
            self._set_mode(PROFILE_POSITION)
        return self.homed

    def prepare_move(self, degrees: float) -> float:
        """Give the drive its next set-point, which it takes on `start_move`.

        Returns
        -------
        float
            Seconds that the move should take.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When the axis is not homed or the drive is not enabled.
        """
        if not self.homed:
            raise DeviceFaultError(f"{self.name}: is not homed, so it is not moved; home it first")
        self._status_in_operation()
        way_deg = abs(degrees - self.degrees())
        self._target_deg = degrees
        self._registers.write("controlword", ENABLE_OPERATION)
        self._registers.write("watchdog_ms", _WATCHDOG_MS)
        self._registers.write("target_position", self.spec.to_counts(degrees))
        return float(move_time(way_deg, self.spec))

    def start_move(self) -> None:
        """Start towards the set-point."""
        self._registers.write("controlword", START)

    def check_started(self) -> None:
        """Make sure that the drive has taken the set-point.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When it refuses.
        """
        # the first read after the edge decides, whatever bit 11 says
        if not self._status_in_operation() & ACKNOWLEDGED:
            raise self.fault(f"the drive refused {self._target_deg:.3f} deg")
        self._registers.write("controlword", ENABLE_OPERATION)

    def has_arrived(self) -> bool:
        """Return whether the set-point is reached, by the drive and by the encoder.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When the drive is no longer enabled, lags behind or ran into a limit switch.
        """
        status = self._status_in_operation()
        if status & (FOLLOWING_ERROR | LIMIT_ACTIVE):
            raise self.fault("stopped on its way")
        if not status & TARGET_REACHED:
            return False
        if abs(self.degrees() - self._target_deg) > self.spec.in_position_deg:
            return False
        self._registers.write("watchdog_ms", IDLE_WATCHDOG_MS)
        return True

    def _knows_position(self) -> bool:
        """Return whether homing is attained, which is read in homing mode."""
        known = TARGET_REACHED | HOMING_ATTAINED
        return self._status_in_operation() & (known | HOMING_ERROR) == known
