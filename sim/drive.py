"""One axis' drive: the state machine of CiA 402 and the objects behind its registers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from sim.axis import AxisMechanics
from sim.homing import Homing
from sim.positioning import Positioning, SetPoint
from sim.registers import check_write, read_span
from sim.states import Command, State, command_of, next_state

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from gonio.rig import Axis
    from sim.vibration import Vibration

BOOT_S = 0.5
"""How long a drive is *not ready to switch on* after power-up."""

OVER_CURRENT = 0x2310
OVER_TEMPERATURE = 0x4310
COMMUNICATION_LOST = 0x7500
FOLLOWING_ERROR = 0x8611

_PROFILE_POSITION, _HOMING = 1, 6
_FAULT_RESET = 0x0080
# voltage enabled and remote: real drives set them, and a driver has to mask them
_ALWAYS = 0x0210
_LIMIT_ACTIVE, _FOLLOWING_ERROR_BIT = 0x0800, 0x2000
_LIMIT_SWITCHES, _INTERLOCK_OPEN = 0x3, 0x8


class Drive:
    """Answers for one unit; whoever asks says what time it is.

    Parameters
    ----------
    spec
        The axis in the rig file.
    vibration
        Of the arm that the axis belongs to.
    position
        Where it stands at power-up, in counts from the home switch's edge.
    now
        When it is switched on.

    Attributes
    ----------
    axis
        The moving parts; `axis.jammed_at` holds the load.
    homing
        `homing.switch_works` breaks the home switch.
    """

    def __init__(self, spec: Axis, vibration: Vibration, position: float, now: float) -> None:
        self.axis = AxisMechanics(spec, vibration, position)
        self.homing = Homing(self.axis, spec)
        self.interlock_open = False
        self._spec = spec
        self._vibration = vibration
        self._following_limit = spec.following_error_deg * self.axis.counts_per_deg
        self._max_velocity = math.ceil(spec.max_velocity_deg_s * self.axis.counts_per_deg)
        self._read: dict[str, Callable[[float], int]] = {
            "controlword": lambda _: self._controlword,
            "statusword": self._statusword,
            "mode": lambda _: self._mode,
            "mode_display": lambda _: self._mode_display,
            "target_position": lambda _: self._target,
            "position_actual": self.axis.encoder,
            "profile_velocity": lambda _: self._velocity,
            "profile_acceleration": lambda _: self._acceleration,
            "following_error": self.axis.following_error,
            "error_code": lambda _: self._error,
            "digital_inputs": self._inputs,
            "watchdog_ms": lambda _: self._watchdog_ms,
            "settle_urad": self._vibration.settle_urad,
        }
        self._write: dict[str, Callable[[int, float], None]] = {
            "controlword": self._command,
            "mode": self._set_mode,
            "target_position": self._set_target,
            "profile_velocity": self._set_velocity,
            "profile_acceleration": self._set_acceleration,
            "watchdog_ms": self._set_watchdog,
        }
        self.power_up(now)

    def power_up(self, now: float) -> None:
        """Be switched off and on: registers at reset, position lost."""
        self._state = State.NOT_READY
        self._ready_s = now + BOOT_S
        self._controlword = self._mode = self._mode_display = 0
        self._target = self._error = self._watchdog_ms = 0
        self._velocity = self._max_velocity // 4
        self._acceleration = math.ceil(
            self._spec.max_acceleration_deg_s2 * self.axis.counts_per_deg / 4
        )
        self._asked_s = now
        self._positioning = Positioning(self.axis)
        self.homing.forget()
        self.axis.let_go(now)
        self.axis.lose_position(now)

    @property
    def target(self) -> int:
        """The target position register, in counts."""
        return self._target

    def read(self, address: int, count: int, now: float) -> list[int]:
        """Answer function 3.

        Raises
        ------
        sim.registers.RefusedError
            With the exception's code.
        """
        self.advance(now)
        words = [
            (self._read[name](now) >> shift) & 0xFFFF for name, shift in read_span(address, count)
        ]
        self._asked_s = now
        return words

    def write(self, address: int, values: Sequence[int], now: float) -> None:
        """Answer functions 6 and 16 (errors as for `read`)."""
        self.advance(now)
        for name, value in check_write(address, values):
            self._write[name](value, now)
        self._asked_s = now
        self.advance(now)

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

    def trip(self, error: int, now: float) -> None:
        """Fault with an error code: stop on a ramp, then wait for a reset."""
        if self._state in (State.FAULT, State.FAULT_REACTION):
            return
        self._error = error
        self._leave_operation(now)
        self._state = State.FAULT_REACTION if self.axis.moving else State.FAULT

    def set_interlock(self, is_open: bool, now: float) -> None:
        """Open or close the safety circuit."""
        self.interlock_open = is_open
        if is_open and self._state is State.ENABLED:
            self._enter(State.QUICK_STOP, now)
        elif is_open and self._state in (State.READY, State.SWITCHED_ON):
            self._state = State.SWITCH_ON_DISABLED

    def _command(self, word: int, now: float) -> None:
        rising = word & ~self._controlword
        self._controlword = word
        state = self._state
        if state is State.FAULT:
            if rising & _FAULT_RESET:
                self._error = 0
                self._state = State.SWITCH_ON_DISABLED
            return
        self._obey(command_of(word), now)
        if state is State.ENABLED and self._state is State.ENABLED:
            self._operate(word, rising, now)

    def _obey(self, command: Command, now: float) -> None:
        state = next_state(self._state, command)
        if state is State.READY and self.interlock_open:
            return
        if state is not self._state:
            self._enter(state, now)

    def _enter(self, state: State, now: float) -> None:
        if self._state is State.ENABLED:
            self._leave_operation(now)
        self._state = state
        if state is State.ENABLED:
            self._positioning.begin(self._controlword)
        elif state is State.QUICK_STOP and not self.axis.moving:
            self._state = State.SWITCH_ON_DISABLED

    def _leave_operation(self, now: float) -> None:
        self._positioning.give_up()
        self.homing.interrupt()
        self.axis.stop(now)

    def _operate(self, word: int, rising: int, now: float) -> None:
        if self._mode_display == _PROFILE_POSITION:
            point = SetPoint(self._target, self._velocity, self._acceleration)
            self._positioning.command(word, rising, point, self.homing.attained, now)
        elif self._mode_display == _HOMING:
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

    def _check_following(self, now: float) -> None:
        if abs(self.axis.following_error(now)) > self._following_limit:
            self.axis.let_go(now)
            self.trip(FOLLOWING_ERROR, now)

    def _watchdog_due(self) -> float:
        if self._watchdog_ms and self._state is State.ENABLED:
            return self._asked_s + self._watchdog_ms / 1000.0
        return math.inf

    def _statusword(self, now: float) -> int:
        word = self._state.value | _ALWAYS
        if self._positioning.refused or self._inputs(now) & _LIMIT_SWITCHES:
            word |= _LIMIT_ACTIVE
        if self._mode_display == _PROFILE_POSITION:
            word |= self._positioning.status()
            word |= _FOLLOWING_ERROR_BIT if self._error == FOLLOWING_ERROR else 0
        elif self._mode_display == _HOMING:
            word |= self.homing.status()
        return word

    def _inputs(self, now: float) -> int:
        return self.axis.inputs(now) | (_INTERLOCK_OPEN if self.interlock_open else 0)

    def _set_mode(self, value: int, _: float) -> None:
        self._mode = value
        self._show_mode()

    def _show_mode(self) -> None:
        if self._mode != self._mode_display and not self.axis.moving:
            self._positioning.give_up()
            self._mode_display = self._mode

    def _set_target(self, value: int, _: float) -> None:
        self._target = value

    def _set_velocity(self, value: int, _: float) -> None:
        self._velocity = min(value, self._max_velocity)

    def _set_acceleration(self, value: int, _: float) -> None:
        self._acceleration = value

    def _set_watchdog(self, value: int, _: float) -> None:
        self._watchdog_ms = value
