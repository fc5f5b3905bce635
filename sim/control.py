"""What a drive does: its state machine, what moves it, and what stops it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from sim.axis import AxisMechanics
from sim.homing import Homing
from sim.positioning import Positioning
from sim.states import Command, State, command_of, next_state

if TYPE_CHECKING:
    from gonio.rig import Axis
    from sim.fittings import Fittings
    from sim.positioning import SetPoint

BOOT_S = 0.5
"""How long a drive is *not ready to switch on* after power-up."""

COMMUNICATION_LOST = 0x7500
FOLLOWING_ERROR = 0x8611

_PROFILE_POSITION, _HOMING = 1, 6
_FAULT_RESET = 0x0080
# voltage enabled and remote: real drives set them, and a driver has to mask them
_ALWAYS = 0x0210
_LIMIT_ACTIVE, _FOLLOWING_ERROR_BIT = 0x0800, 0x2000
_LIMIT_SWITCHES, _INTERLOCK_OPEN = 0x3, 0x8


class DriveControl:
    """The state machine of CiA 402 over one axis.

    Parameters
    ----------
    spec
        The axis in the rig file.
    fittings
        What it is fitted with beside its motor.
    position
        Where it stands at power-up, in counts from the home switch's edge.

    Attributes
    ----------
    axis
        The moving parts; `axis.jammed_at` holds the load.
    homing
        `homing.switch_works` breaks the home switch.
    error, mode, mode_display, watchdog_ms
        As the registers say.
    asked_s
        When a request was last answered well.
    hurry
        How many times faster than the host's this clock runs; the watchdog counts the host's time.
    """

    def __init__(self, spec: Axis, fittings: Fittings, position: float) -> None:
        self.axis = AxisMechanics(spec, fittings, position)
        self.homing = Homing(self.axis, spec)
        self._following_limit = spec.following_error_deg * self.axis.counts_per_deg
        self._interlock_open = False
        self.hurry = 1.0

    def power_up(self, now: float) -> None:
        """Be switched off and on: nothing set, position lost."""
        self.error = self.mode = self.mode_display = self.watchdog_ms = 0
        self.asked_s = now
        self._state = State.NOT_READY
        self._ready_s = now + BOOT_S
        self._positioning = Positioning(self.axis)
        self.homing.forget()
        self.axis.let_go(now)
        self.axis.lose_position(now)

    def advance(self, now: float) -> None:
        """Let everything happen that is due by `now`, in its order."""
        while (due := min(self.axis.end_s, self._ready_s, self._watchdog_due())) <= now:
            if due == self._ready_s:
                self._state, self._ready_s = State.SWITCH_ON_DISABLED, math.inf
            elif due == self.axis.end_s:
                self._arrived(due)
            else:
                self.trip(COMMUNICATION_LOST, due)
        if self.axis.jammed_at is not None and self._state is State.ENABLED:
            self._check_following(now)

    def command(self, word: int, rising: int, point: SetPoint, now: float) -> None:
        """Act on a controlword.

        Parameters
        ----------
        word
            The controlword.
        rising
            The bits that it sets newly.
        point
            What a new set-point would be.
        now
            The time.
        """
        state = self._state
        if state is State.FAULT:
            if rising & _FAULT_RESET:
                self.error = 0
                self._state = State.SWITCH_ON_DISABLED
            return
        self._obey(command_of(word), word, now)
        if state is State.ENABLED and self._state is State.ENABLED:
            self._operate(word, rising, point, now)

    def set_mode(self, mode: int) -> None:
        """Change the mode, at standstill."""
        self.mode = mode
        self._show_mode()

    def trip(self, error: int, now: float) -> None:
        """Fault with an error code: stop on a ramp, then wait for a reset."""
        if self._state in (State.FAULT, State.FAULT_REACTION):
            return
        self.error = error
        self._leave_operation(now)
        self._state = State.FAULT_REACTION if self.axis.moving else State.FAULT

    def hit_limit(self, now: float) -> None:
        """Run into a limit switch: the axis stops, and its set-points are given up."""
        self.axis.close_switch(now)
        self._positioning.give_up()
        self.axis.stop(now)

    def set_interlock(self, is_open: bool, now: float) -> None:
        """Open or close the safety circuit."""
        self._interlock_open = is_open
        if is_open and self._state is State.ENABLED:
            self._enter(State.QUICK_STOP, now)
        elif is_open and self._state in (State.READY, State.SWITCHED_ON):
            self._state = State.SWITCH_ON_DISABLED

    def statusword(self, now: float) -> int:
        """Return the statusword."""
        word = self._state.value | _ALWAYS
        if self._positioning.refused or self.axis.inputs(now) & _LIMIT_SWITCHES:
            word |= _LIMIT_ACTIVE
        if self.mode_display == _PROFILE_POSITION:
            word |= self._positioning.status()
            word |= _FOLLOWING_ERROR_BIT if self.error == FOLLOWING_ERROR else 0
        elif self.mode_display == _HOMING:
            word |= self.homing.status()
        return word

    def inputs(self, now: float) -> int:
        """Return the digital inputs."""
        return self.axis.inputs(now) | (_INTERLOCK_OPEN if self._interlock_open else 0)

    def _obey(self, command: Command, word: int, now: float) -> None:
        state = next_state(self._state, command)
        if state is State.READY and self._interlock_open:
            return
        if state is State.ENABLED and self._state is not State.ENABLED:
            self._positioning.begin(word)
            if not self.axis.moving:
                # a drive that takes over holds the load where it finds it
                self.axis.let_go(now)
        if state is not self._state:
            self._enter(state, now)

    def _enter(self, state: State, now: float) -> None:
        if self._state is State.ENABLED:
            self._leave_operation(now)
        self._state = state
        if state is State.QUICK_STOP and not self.axis.moving:
            self._state = State.SWITCH_ON_DISABLED

    def _leave_operation(self, now: float) -> None:
        self._positioning.give_up()
        self.homing.interrupt()
        self.axis.stop(now)

    def _operate(self, word: int, rising: int, point: SetPoint, now: float) -> None:
        if self.mode_display == _PROFILE_POSITION:
            self._positioning.command(word, rising, point, self.homing.attained, now)
        elif self.mode_display == _HOMING:
            self.homing.command(word, rising, now)

    def _arrived(self, now: float) -> None:
        self.axis.finish()
        if self._state is State.QUICK_STOP:
            self._state = State.SWITCH_ON_DISABLED
        elif self._state is State.FAULT_REACTION:
            self._state = State.FAULT
        elif self.homing.running:
            self.homing.arrived(now)
        else:
            self._positioning.arrived(now)
        self._show_mode()

    def _show_mode(self) -> None:
        if self.mode != self.mode_display and not self.axis.moving:
            self._positioning.give_up()
            self.mode_display = self.mode

    def _check_following(self, now: float) -> None:
        if abs(self.axis.following_error(now)) > self._following_limit:
            self.axis.let_go(now)
            self.trip(FOLLOWING_ERROR, now)

    def _watchdog_due(self) -> float:
        if self.watchdog_ms and self._state is State.ENABLED:
            return self.asked_s + self.hurry * self.watchdog_ms / 1000.0
        return math.inf
