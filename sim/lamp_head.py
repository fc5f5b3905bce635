"""The lamp head: eleven lamps, the camera's shutter, a watchdog and a queue of errors."""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING

from sim.led import COOL_AGAIN_C, Led
from sim.shutter import Shutter

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.clock import VirtualClock
    from sim.tether import Scene, Tether

LAMPS = 11

UNKNOWN, BAD_CHECKSUM, OUT_OF_RANGE = 100, 101, 200
OVER_TEMPERATURE, OPEN_CIRCUIT, OVERFLOW = 300, 301, 350
INTERLOCK_OPEN, CAMERA_BUSY = 400, 500

_MAX_ERRORS = 32
_MAX_CURRENT_MA = 700.0
_MAX_EXPOSURE_US = 300_000_000
_MAX_WATCHDOG_MS = 3_600_000


class LampError(Exception):
    """A request that is answered with ERR."""

    def __init__(self, code: int) -> None:
        super().__init__(f"error {code}")
        self.code = code


class LampHead:
    """What the head does, whatever it is asked through.

    Parameters
    ----------
    clock
        On which lamps warm up and exposures end.
    tether
        The camera whose shutter it opens.
    scene
        Returns what the camera has before it: given the exposure in us and the lamps' state.

    Attributes
    ----------
    leds
        The lamps; `lose_cooling` spoils one.
    shutter
        The camera's.
    hurry
        How many times faster than the host's this clock runs; the watchdog counts the host's time.
    """

    def __init__(
        self, clock: VirtualClock, tether: Tether, scene: Callable[[int, str], Scene]
    ) -> None:
        self._clock = clock
        self._tether = tether
        self._scene = scene
        self.leds = tuple(Led(clock.now()) for _ in range(LAMPS))
        self.shutter = Shutter(clock, tether, self.leds)
        self._errors: deque[int] = deque()
        self.hurry = 1.0
        self._interlock_open = False
        self._watchdog_s = 0.0
        self._asked_s = clock.now()

    def slow_down(self, electronics_us: float) -> None:
        """Let the lamps' currents follow with that time constant; 0: at once."""
        for led in self.leds:
            led.electronics_s = electronics_us / 1e6

    def advance(self) -> None:
        """Let everything happen that is due, in its order."""
        now = self._clock.now()
        while (due := min(self.shutter.closes_s, self._watchdog_due(), self._too_hot_due())) <= now:
            if due == self.shutter.closes_s:
                self.shutter.close()
            elif due == self._watchdog_due():
                self._switch_off(due)
            else:
                self._trip(due)

    def asked(self) -> None:
        """Note that a request was answered well."""
        self._asked_s = self._clock.now()

    def queue(self, code: int) -> None:
        """Queue an error; when the queue is full, its last entry says so."""
        if len(self._errors) < _MAX_ERRORS:
            self._errors.append(code)
        else:
            self._errors[-1] = OVERFLOW

    def next_error(self) -> int:
        """Take the oldest error out of the queue; 0 when there is none."""
        return self._errors.popleft() if self._errors else 0

    def set_interlock(self, is_open: bool) -> None:
        """Open or close the safety circuit."""
        self.advance()
        self._interlock_open = is_open
        if is_open and any(led.on for led in self.leds):
            self._switch_off(self._clock.now())
            self.queue(INTERLOCK_OPEN)

    def break_circuit(self, n: int) -> None:
        """Let lamp `n` burn out; it says so unasked if it was lit."""
        self.advance()
        led = self.led(n)
        was_on = led.on
        led.break_circuit(self._clock.now())
        if was_on:
            self.queue(OPEN_CIRCUIT)

    def mend_circuit(self, n: int) -> None:
        """Let lamp `n` have contact again."""
        self.led(n).is_open = False

    def overheat(self, n: int) -> None:
        """Let lamp `n` get too hot; it says so unasked and switches itself off."""
        self.advance()
        self.led(n).heat_up(self._clock.now())
        self.queue(OVER_TEMPERATURE)

    def led(self, n: int) -> Led:
        """Return lamp `n`, from 1.

        Raises
        ------
        LampError
            When there is none of that number.
        """
        if not 1 <= n <= LAMPS:
            raise LampError(OUT_OF_RANGE)
        return self.leds[n - 1]

    def set_current(self, n: int, current_mA: float) -> None:
        """Set a current in mA."""
        led = self.led(n)
        _check_range(current_mA, 0.0, _MAX_CURRENT_MA)
        led.set(self._clock.now(), current_mA=current_mA)

    def switch(self, n: int, on: bool) -> None:
        """Switch a lamp.

        Raises
        ------
        LampError
            When it may not or cannot be lit.
        """
        led, now = self.led(n), self._clock.now()
        if on:
            if self._interlock_open:
                raise LampError(INTERLOCK_OPEN)
            if led.is_open:
                raise LampError(OPEN_CIRCUIT)
            if led.tripped and led.temperature_c(now) >= COOL_AGAIN_C:
                raise LampError(OVER_TEMPERATURE)
            led.tripped = False
        led.set(now, on=on)

    def all_off(self) -> None:
        """Switch every lamp off."""
        self._switch_off(self._clock.now())

    def temperature_c(self, n: int) -> float:
        """Return a junction's temperature in deg C."""
        return self.led(n).temperature_c(self._clock.now())

    def flux(self, n: int) -> float:
        """Return a lamp's light now."""
        return self.led(n).flux(self._clock.now())

    def set_watchdog(self, milliseconds: int) -> None:
        """Set the watchdog; 0 is off."""
        _check_range(milliseconds, 0, _MAX_WATCHDOG_MS)
        self._watchdog_s = milliseconds / 1000.0

    def expose(self, exposure_us: int) -> int:
        """Open the shutter and return the frame's number.

        Raises
        ------
        LampError
            When the camera is busy.
        """
        _check_range(exposure_us, 1, _MAX_EXPOSURE_US)
        if self._tether.busy():
            raise LampError(CAMERA_BUSY)
        return self.shutter.open(exposure_us, self._scene(exposure_us, self._lit()), self.advance)

    def _trip(self, now: float) -> None:
        for led in self.leds:
            if led.overheats_at_s <= now:
                led.trip(now)
                self.queue(OVER_TEMPERATURE)

    def _switch_off(self, now: float) -> None:
        for led in self.leds:
            if led.on:
                led.set(now, on=False)

    def _watchdog_due(self) -> float:
        if self._watchdog_s and any(led.on for led in self.leds):
            return self._asked_s + self.hurry * self._watchdog_s
        return math.inf

    def _too_hot_due(self) -> float:
        return min(led.overheats_at_s for led in self.leds)

    def _lit(self) -> str:
        lit = [f"{n}:{led.current_mA:.1f}" for n, led in enumerate(self.leds, 1) if led.on]
        return ",".join(lit)


def _check_range(value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise LampError(OUT_OF_RANGE)
