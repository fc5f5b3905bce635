"""The arm: four axes that move together, wait until they are still, and stop together."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from gonio.approach import first_stop_deg
from gonio.clearance import limits_of
from gonio.devices.axis import AxisDrive
from gonio.devices.registers import DriveRegisters
from gonio.devices.troubles import Troubles
from gonio.devices.waiting import wait_until
from gonio.errors import BadInputError, DeviceFaultError, GonioError
from gonio.profiles import load_profile
from gonio.rig import AXES
from gonio.swept import START_SKEW_S

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

    from gonio.clock import Clock
    from gonio.devices.drive import DriveStatus
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
    troubles
        Told what the drivers mended by themselves.
    underway
        To wait on while axes are on their way, when something else may be done; the clock, unless
        given.
    """

    def __init__(
        self,
        bus: RegisterBus,
        rig: Rig,
        clock: Clock,
        troubles: Troubles | None = None,
        underway: Clock | None = None,
    ) -> None:
        profile, troubles = load_profile(rig.arm.profile), troubles or Troubles()
        self._rig = rig
        self._clock = underway or clock
        self._axes = {
            name: AxisDrive(
                name,
                rig.axis[name],
                DriveRegisters(bus, rig.axis[name].unit, profile, clock, troubles),
                clock,
                troubles,
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

    def home(self, anew: Collection[str] = ()) -> None:
        """Home all axes that do not know their position, at once.

        Parameters
        ----------
        anew
            Names of axes to home though they know it.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When homing fails or takes longer than `homing_timeout_s`.
        """
        with self._stopped_on_fault():
            timeout_s = self._rig.arm.homing_timeout_s
            deadline_s = self._clock.now() + timeout_s
            waiting = [
                axis for name, axis in self._axes.items() if axis.begin_homing(anew=name in anew)
            ]
            while waiting := [axis for axis in waiting if not axis.has_homed()]:
                if self._clock.now() >= deadline_s:
                    raise waiting[0].fault(f"is not home after {timeout_s:g} s")
                self._clock.sleep(_HOMING_POLL_S)

    def move(
        self, angles_deg: Mapping[str, float], via: Sequence[Mapping[str, float]] = ()
    ) -> None:
        """Move axes together and wait until they are in position and still.

        Parameters
        ----------
        angles_deg
            Angle in degrees by the axis' name; axes that are not named stay.
        via
            Angles to pass first, one after the other, without waiting until the arm is still.

        Raises
        ------
        gonio.errors.BadInputError
            For an angle beyond the travel; nothing has moved then.
        gonio.errors.DeviceFaultError
            When an axis is not homed, a drive refuses or fails, or the arm does not get still.
        """
        self.go(angles_deg, via)
        self.settle(angles_deg)

    def go(self, angles_deg: Mapping[str, float], via: Sequence[Mapping[str, float]] = ()) -> None:
        """Move as `move` does, and wait until the axes are in position, however they shake."""
        for angles in (*via, angles_deg):
            self._check_reach(angles)
        with self._stopped_on_fault():
            for angles in via:
                self._go(angles)
            detours = self._detours(angles_deg)
            if detours:
                self._go({**angles_deg, **detours})
            self._go({name: angles_deg[name] for name in detours or angles_deg})

    def settle(self, angles_deg: Mapping[str, float]) -> None:
        """Wait until the arms of the axes named are still.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When one does not get still.
        """
        with self._stopped_on_fault():
            self._settle(angles_deg)

    def shaking_urad(self, name: str) -> int:
        """Return the residual vibration of the arm of an axis; 65535 while it moves."""
        return self._axes[name].settle_urad()

    def angles_deg(self) -> dict[str, float]:
        """Return where all axes are by their encoders, in degrees."""
        return {name: axis.resting_degrees() for name, axis in self._axes.items()}

    def says(self, name: str) -> DriveStatus:
        """Return what the drive of an axis says of itself; nothing is changed."""
        return self._axes[name].says()

    def check_homed(self) -> None:
        """Refuse to go on where an axis does not know its position.

        Raises
        ------
        gonio.errors.DeviceFaultError
            Naming the axis.
        """
        for axis in self._axes.values():
            if not axis.finds_itself_homed():
                raise DeviceFaultError(f"{axis.name}: is not homed; home it with gonio rig home")

    def interlock_is_open(self) -> bool:
        """Return whether a door is open or an emergency stop pressed, by any of the drives."""
        return any(axis.interlock_is_open() for axis in self._axes.values())

    def attend(self) -> None:
        """Let the drives' watchdogs hear that the host lives (errors as for `enable`)."""
        self._each(AxisDrive.attend)

    def try_to_attend(self) -> None:
        """Do so once, amid a wait for others: a drive that is gone is met by who next needs it."""
        self._each(AxisDrive.try_to_attend)

    def try_to_stop(self) -> None:
        """Send every axis its quick stop at once and only once, and wait for none."""
        self._each(AxisDrive.try_to_stop)

    def stop(self) -> None:
        """Stop all axes on the quickest ramp; they end disabled.

        Raises
        ------
        gonio.errors.DeviceFaultError
            The first of what failed, after every axis was told to stop.
        """
        self._each(AxisDrive.try_to_stop, AxisDrive.begin_stop, AxisDrive.end_stop)

    def release(self) -> None:
        """Disable all axes (errors as for `stop`)."""
        self._each(AxisDrive.release)

    def _check_reach(self, angles_deg: Mapping[str, float]) -> None:
        for name, angle in angles_deg.items():
            if name not in self._axes:
                raise BadInputError(f"there is no axis {name!r}; use {', '.join(AXES)}")
            self._rig.check_reach(name, angle)

    def _detours(self, angles_deg: Mapping[str, float]) -> dict[str, float]:
        """Return where axes that are approached from one side go first."""
        detours = {}
        for name, angle in angles_deg.items():
            axis = self._axes[name]
            start = float(first_stop_deg(axis.degrees(), angle, axis.spec))
            if start != angle:
                detours[name] = start
        return detours

    def _go(self, angles_deg: Mapping[str, float]) -> None:
        axes = [self._axes[name] for name in angles_deg]
        expected_s = [self._axes[name].prepare_move(angle) for name, angle in angles_deg.items()]
        longest_s = max(expected_s, default=0.0)
        began_s = self._clock.now()
        # one right after the other: what the arms sweep hangs on it
        for axis in axes:
            axis.start_move()
        if len(axes) > 1:
            self._check_started_together(self._clock.now() - began_s)
        for axis in axes:
            axis.check_started()
        deadline_s = began_s + _SLACK * longest_s + _SLACK_S
        while axes := [axis for axis in axes if not axis.has_arrived()]:
            now = self._clock.now()
            if now >= deadline_s:
                late = axes[0]
                raise late.fault(f"did not arrive within {now - began_s:.1f} s")
            left_s = began_s + longest_s - now
            self._clock.sleep(min(max(left_s, _FINE_POLL_S), _COARSE_POLL_S))

    def _check_started_together(self, took_s: float) -> None:
        """Refuse starts so far apart that the arms may leave the way that was found clear."""
        if took_s > START_SKEW_S and limits_of(self._rig):
            raise DeviceFaultError(
                f"the axes started within {took_s:.3g} s, and ways clear of arm.keep_out and "
                f"arm.min_separation_deg need {START_SKEW_S:g} s; look for what delays the bus, "
                "then resume"
            )

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
