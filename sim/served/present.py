"""Simulated time that follows the machine's."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from datetime import datetime

    from gonio.clock import Clock, VirtualClock


class Present:
    """Keeps a virtual clock at the present.

    Parameters
    ----------
    clock
        The twin's.
    speed
        How many times faster than the machine's it runs.
    """

    def __init__(self, clock: VirtualClock, speed: float) -> None:
        self._clock, self._speed = clock, speed
        self._start_s, self._began_s = clock.now(), time.monotonic()

    def catch_up(self) -> None:
        """Let everything happen that is due by now."""
        passed_s = self._speed * (time.monotonic() - self._began_s)
        self._clock.sleep(self._start_s + passed_s - self._clock.now())


class WireClock:
    """The clock of wires that take their time themselves: nobody sleeps on it."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock

    def now(self) -> float:
        """Return the twin's time."""
        return self._clock.now()

    def sleep(self, seconds: float) -> None:
        """Let no time pass."""

    def utc(self) -> datetime:
        """Return the twin's date and time."""
        return self._clock.utc()
