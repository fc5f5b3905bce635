"""One axis of the arm: its drive, stepped through CiA 402, and its encoder."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gonio.devices.faults import cause_of
from gonio.devices.states import (
    ACKNOWLEDGED,
    DISABLE_VOLTAGE,
    ENABLE_OPERATION,
    FOLLOWING_ERROR,
    HOMING,
    HOMING_ATTAINED,
    HOMING_ERROR,
    LIMIT_ACTIVE,
    MOVING_BY_ITSELF,
    PROFILE_POSITION,
    QUICK_STOP,
    START,
    STEPS,
    TARGET_REACHED,
    DriveState,
    state_of,
)
from gonio.devices.waiting import wait_until
from gonio.errors import DeviceFaultError
from gonio.timemodel import move_time

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.clock import Clock
    from gonio.devices.registers import DriveRegisters
    from gonio.rig import Axis

_POLL_S = 0.02
# a drive that is asked nothing for so long while it moves stops by itself: the host is gone
_WATCHDOG_MS = 3000
_STEP_TIMEOUT_S = 5.0
_MAX_STEPS = 12


class AxisDrive:
    """One axis.

    Parameters
    ----------
    name
        As in the rig file.
    spec
        Scale, travel and speed.
    registers
        The drive's.
    clock
        To wait on.

    Attributes
    ----------
    homed
        Whether the drive has said that it knows its position.
    """

    def __init__(self, name: str, spec: Axis, registers: DriveRegisters, clock: Clock) -> None:
        self.name = name
        self.spec = spec
        self.homed = False
        self._registers = registers
        self._clock = clock
        self._target_deg = math.nan

    def degrees(self) -> float:
        """Return the angle by the encoder."""
        return self.spec.to_degrees(self._registers.read("position_actual"))

    def settle_urad(self) -> int:
        """Return the residual vibration of the axis' arm."""
        return self._registers.read("settle_urad")

    def enable(self) -> None:
        """Bring the drive into *operation enabled*, one transition at a time, and set it up.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When it does not follow.
        """
        if self._state() is DriveState.ENABLED:
            # whatever an earlier run left under way
            self.begin_stop()
            self.end_stop()
        for _ in range(_MAX_STEPS):
            state = self._state()
            if state is DriveState.ENABLED:
                break
            self._step_from(state)
        else:
            raise self.fault("does not get enabled")
        self._set_mode(PROFILE_POSITION)
        scale = abs(self.spec.counts_per_deg)
        self._set("watchdog_ms", 0)
        self._set("profile_velocity", max(int(self.spec.max_velocity_deg_s * scale), 1))
        self._set("profile_acceleration", max(int(self.spec.max_acceleration_deg_s2 * scale), 1))

    def begin_homing(self) -> bool:
        """Start homing, unless the position is known; return whether it was started."""
        self._set_mode(HOMING)
        self.homed = self._knows_position()
        if self.homed:
            self._set_mode(PROFILE_POSITION)
            return False
        self._registers.write("watchdog_ms", _WATCHDOG_MS)
        # bit 4 stays at 1 until homing is over; clearing it interrupts
        self._registers.write("controlword", START)
        return True

    def has_homed(self) -> bool:
        """Return whether homing is over, and go back to profile position mode when it is.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When homing failed or the drive is no longer enabled.
        """
        self.homed = self._knows_position()
        if self.homed:
            self._registers.write("controlword", ENABLE_OPERATION)
            self._registers.write("watchdog_ms", 0)
            self._set_mode(PROFILE_POSITION)
        return self.homed

    def begin_move(self, degrees: float) -> float:
        """Give the drive a set-point.

        Returns
        -------
        float
            Seconds that the move should take.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When the axis is not homed or the drive refuses.
        """
        if not self.homed:
            raise DeviceFaultError(f"{self.name}: is not homed, so it is not moved; home it first")
        self._status_in_operation()
        way_deg = abs(degrees - self.degrees())
        self._target_deg = degrees
        self._registers.write("controlword", ENABLE_OPERATION)
        self._registers.write("watchdog_ms", _WATCHDOG_MS)
        self._registers.write("target_position", self.spec.to_counts(degrees))
        self._registers.write("controlword", START)
        # the first read after the edge decides, whatever bit 11 says
        if not self._status_in_operation() & ACKNOWLEDGED:
            raise self.fault(f"the drive refused {degrees:.3f} deg")
        self._registers.write("controlword", ENABLE_OPERATION)
        return float(move_time(way_deg, self.spec))

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
        self._registers.write("watchdog_ms", 0)
        return True

    def begin_stop(self) -> None:
        """Stop on the quickest ramp, which ends disabled."""
        self._registers.write("controlword", QUICK_STOP)

    def end_stop(self) -> None:
        """Wait until the drive has stopped by itself.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When it does not say so in time.
        """
        underway = (DriveState.ENABLED, *MOVING_BY_ITSELF)
        if not self._wait(lambda: self._state() not in underway):
            raise self.fault("does not stop")

    def release(self) -> None:
        """Disable the drive."""
        self._registers.write("controlword", DISABLE_VOLTAGE)

    def fault(self, what: str) -> DeviceFaultError:
        """Say what happened, why as far as the drive tells, where, and what to do."""
        cause, remedy = cause_of(self._registers)
        return DeviceFaultError(
            f"{self.name}: {what} ({cause}) at {self.degrees():.2f} deg; {remedy}, then resume"
        )

    def _knows_position(self) -> bool:
        """Return whether homing is attained, which is read in homing mode."""
        status = self._status_in_operation()
        if status & HOMING_ERROR:
            raise self.fault("homing failed")
        known = TARGET_REACHED | HOMING_ATTAINED
        return status & known == known

    def _state(self) -> DriveState:
        return state_of(self._registers.read("statusword"))

    def _status_in_operation(self) -> int:
        """Return the statusword of an enabled drive."""
        status = self._registers.read("statusword")
        if state_of(status) is not DriveState.ENABLED:
            raise self.fault("is no longer enabled")
        return status

    def _step_from(self, state: DriveState) -> None:
        for controlword in STEPS.get(state, ()):
            self._registers.write("controlword", controlword)
        if not self._wait(lambda: self._state() is not state):
            raise self.fault(f"stays in '{state.value}'")

    def _set_mode(self, mode: int) -> None:
        self._registers.write("mode", mode)
        if not self._wait(lambda: self._registers.read("mode_display") == mode):
            raise self.fault(f"does not take mode {mode}")

    def _set(self, name: str, value: int) -> None:
        self._registers.write(name, value)
        kept = self._registers.read(name)
        if kept != value:
            raise DeviceFaultError(
                f"{self.name}: the drive keeps {name} {kept} instead of {value}; "
                "compare speed and counts_per_deg in the rig file with the drive's limits"
            )

    def _wait(self, condition: Callable[[], bool]) -> bool:
        return wait_until(self._clock, condition, _STEP_TIMEOUT_S, _POLL_S)
