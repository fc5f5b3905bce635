"""A drive of CiA 402: enabled step by step, stopped, released, and asked why it failed."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from gonio.devices.faults import INTERLOCK_OPEN, cause_of
from gonio.devices.states import (
    DISABLE_VOLTAGE,
    MOVING_BY_ITSELF,
    PROFILE_POSITION,
    QUICK_STOP,
    STEPS,
    DriveState,
    state_of,
)
from gonio.devices.waiting import wait_until
from gonio.errors import DeviceFaultError

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.clock import Clock
    from gonio.devices.registers import DriveRegisters
    from gonio.rig import Axis

IDLE_WATCHDOG_MS = 60_000
"""A drive that holds its axis lets go when it hears nothing for so long: the host is gone."""

_POLL_S = 0.02
_STEP_TIMEOUT_S = 5.0
_MAX_STEPS = 12


class DriveStatus(NamedTuple):
    """What a drive says of itself.

    Attributes
    ----------
    state
        One of the eight of CiA 402.
    cause, remedy
        What keeps it from work, in words, and what to do about it; the remedy is empty where
        nothing does.
    degrees
        By the encoder; it means nothing before the axis is homed.
    """

    state: str
    cause: str
    remedy: str
    degrees: float


class Drive:
    """The drive of one axis.

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
    """

    def __init__(self, name: str, spec: Axis, registers: DriveRegisters, clock: Clock) -> None:
        self.name = name
        self.spec = spec
        self._registers = registers
        self._clock = clock

    def degrees(self) -> float:
        """Return the angle by the encoder."""
        return self.spec.to_degrees(self._registers.read("position_actual"))

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
        self._set("watchdog_ms", IDLE_WATCHDOG_MS)
        self._set("profile_velocity", max(int(self.spec.max_velocity_deg_s * scale), 1))
        self._set("profile_acceleration", max(int(self.spec.max_acceleration_deg_s2 * scale), 1))

    def attend(self) -> None:
        """Ask for no more than that the watchdog hears of it."""
        self._registers.read("statusword")

    def try_to_attend(self) -> None:
        """Ask once, whether or not it answers."""
        self._registers.try_to_read("statusword")

    def try_to_stop(self) -> None:
        """Send a quick stop at once and only once: others wait for theirs."""
        self._registers.try_to_write("controlword", QUICK_STOP)

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

    def says(self) -> DriveStatus:
        """Ask the drive how it is, and change nothing (errors as for `enable`)."""
        state = self._state()
        cause, remedy = cause_of(self._registers)
        well = cause.startswith("drive is in")
        return DriveStatus(
            state.value, "no fault" if well else cause, "" if well else remedy, self.degrees()
        )

    def interlock_is_open(self) -> bool:
        """Return whether the drive says so."""
        return bool(self._registers.read("digital_inputs") & INTERLOCK_OPEN)

    def fault(self, what: str) -> DeviceFaultError:
        """Say what happened, why as far as the drive tells, where, and what to do."""
        cause, remedy = cause_of(self._registers)
        return DeviceFaultError(
            f"{self.name}: {what} ({cause}) at {self.degrees():.2f} deg; {remedy}, then resume"
        )

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
