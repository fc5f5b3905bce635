"""The arm: four axes that move together, wait until they are still, and stop together."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from gonio.approach import first_stop_deg
from gonio.devices.axis import AxisDrive
from gonio.devices.registers import DriveRegisters
from gonio.devices.waiting import wait_until
from gonio.errors import BadInputError, DeviceFaultError, GonioError
from gonio.profiles import load_profile
from gonio.rig import AXES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from gonio.clock import Clock
    from gonio.rig import Rig
    from gonio.transports import RegisterBus

_FINE_POLL_S, _COARSE_POLL_S = 0.02, 0.25
_HOMING_POLL_S = 0.1
_SETTLE_POLL_S = 0.05
_SETTLE_TIMEOUT_S = 15.0
_SLACK, _SLACK_S = 1.5, 5.0


class Arm:
    """Camera arm and light arm, two axes each.

    Every wait has a deadline; when anything fails, all axes are stopped before the error is
    raised.

    Parameters
    ----------
    bus
        Where the drives are.
    rig
        Names the register profile, and describes the axes.
    clock
        To wait on.
    """

    def __init__(self, bus: RegisterBus, rig: Rig, clock: Clock) -> None:
        profile = load_profile(rig.arm.profile)
        self._rig = rig
        self._clock = clock
        self._axes = {
            name: AxisDrive(
                name, rig.axis[name], DriveRegisters(bus, rig.axis[name].unit, profile), clock
            )
            for name in AXES
        }

    def enable(self) -> None:
        """Enable all axes, resetting faults; they stand still.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When a drive does not follow, the interlock is open, or a drive is not there.
        """
        with self._stopped_on_fault():
            for axis in self._axes.values():
                axis.enable()

    def home(self) -> None:
        """Home all axes that do not know their position, at once.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When homing fails or takes longer than `homing_timeout_s`.
        """
        with self._stopped_on_fault():
            timeout_s = self._rig.arm.homing_timeout_s
            deadline_s = self._clock.now() + timeout_s
            waiting = [axis for axis in self._axes.values() if axis.begin_homing()]
            while waiting := [axis for axis in waiting if not axis.has_homed()]:
                if self._clock.now() >= deadline_s:
                    raise waiting[0].fault(f"is not home after {timeout_s:g} s")
                self._clock.sleep(_HOMING_POLL_S)

    def move(self, angles_deg: Mapping[str, float]) -> None:
        """Move axes together and wait until they are in position and still.

        Parameters
        ----------
        angles_deg
            Angle in degrees by the axis' name; axes that are not named stay.

        Raises
        ------
        gonio.errors.BadInputError
            For an angle beyond the travel; nothing has moved then.
        gonio.errors.DeviceFaultError
            When an axis is not homed, a drive refuses or fails, or the arm does not get still.
        """
        for name, angle in angles_deg.items():
            if name not in self._axes:
                raise BadInputError(f"there is no axis {name!r}; use {', '.join(AXES)}")
            self._rig.check_reach(name, angle)
        with self._stopped_on_fault():
            detours = self._detours(angles_deg)
            if detours:
                self._go({**angles_deg, **detours})
            self._go({name: angles_deg[name] for name in detours or angles_deg})
            self._settle(angles_deg)

    def angles_deg(self) -> dict[str, float]:
        """Return where all axes are by their encoders, in degrees."""
        return {name: axis.degrees() for name, axis in self._axes.items()}

    def stop(self) -> None:
        """Stop all axes on the quickest ramp; they end disabled.

        Raises
        ------
        gonio.errors.DeviceFaultError
            The first of what failed, after every axis was told to stop.
        """
        self._each(AxisDrive.begin_stop, AxisDrive.end_stop)

    def release(self) -> None:
        """Disable all axes (errors as for `stop`)."""
        self._each(AxisDrive.release)

    def _detours(self, angles_deg: Mapping[str, float]) -> dict[str, float]:
        """Return where axes that are approached from one side go first."""
        detours = {}
        for name, angle in angles_deg.items():
            axis = self._axes[name]
            stop = float(first_stop_deg(axis.degrees(), angle, axis.spec))
            if stop != angle:
                detours[name] = stop
        return detours

    def _go(self, angles_deg: Mapping[str, float]) -> None:
        expected_s = [self._axes[name].begin_move(angle) for name, angle in angles_deg.items()]
        longest_s = max(expected_s, default=0.0)
        began_s = self._clock.now()
        deadline_s = began_s + _SLACK * longest_s + _SLACK_S
        underway = [self._axes[name] for name in angles_deg]
        while underway := [axis for axis in underway if not axis.has_arrived()]:
            now = self._clock.now()
            if now >= deadline_s:
                late = underway[0]
                raise late.fault(f"did not arrive within {now - began_s:.1f} s")
            left_s = began_s + longest_s - now
            self._clock.sleep(min(max(left_s, _FINE_POLL_S), _COARSE_POLL_S))

    def _settle(self, angles_deg: Mapping[str, float]) -> None:
        # both axes of an arm report the vibration at its end
        ends = {name.partition("_")[0]: self._axes[name] for name in angles_deg}
        for arm, axis in ends.items():
            self._wait_still(arm, axis)

    def _wait_still(self, arm: str, axis: AxisDrive) -> None:
        limit = self._rig.arm.settle_limit_urad

        def is_still() -> bool:
            return axis.settle_urad() <= limit

        if not wait_until(self._clock, is_still, _SETTLE_TIMEOUT_S, _SETTLE_POLL_S):
            raise DeviceFaultError(
                f"{arm} arm: still shakes by {axis.settle_urad()} urad after "
                f"{_SETTLE_TIMEOUT_S:g} s; look for what shakes it, or raise "
                f"settle_limit_urad ({limit:g}) in the rig file"
            )

    def _each(self, *actions: Callable[[AxisDrive], None]) -> None:
        """Do each action with all axes, whatever fails on the way; raise the first failure."""
        failures = []
        for action in actions:
            for axis in self._axes.values():
                try:
                    action(axis)
                except GonioError as error:
                    failures.append(error)
        if failures:
            raise failures[0]

    @contextlib.contextmanager
    def _stopped_on_fault(self) -> Iterator[None]:
        try:
            yield
        except GonioError:
            # the first fault is the one to report, not what it makes of the stop
            with contextlib.suppress(GonioError):
                self.stop()
            raise
