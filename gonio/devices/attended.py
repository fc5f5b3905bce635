"""A clock that does not leave the drives alone: their watchdogs hear of the host while it waits."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from datetime import datetime

    from gonio.clock import Clock

_EVERY_S = 15.0


class AttendedClock:
    """A `gonio.clock.Clock` whose long waits are broken every 15 s to say that the host lives.

    Parameters
    ----------
    clock
        The time.
    attend
        Called in the middle of long waits.
    """

    def __init__(self, clock: Clock, attend: Callable[[], None]) -> None:
        self._clock = clock
        self._attend = attend
        self._waited_s = 0.0

    def now(self) -> float:
        """Return the clock's time."""
        return self._clock.now()

    def sleep(self, seconds: float) -> None:
        """Let `seconds` pass."""
        left_s = seconds
        while left_s > 0:
            step_s = min(left_s, _EVERY_S - self._waited_s)
            self._clock.sleep(step_s)
            left_s -= step_s
            self._waited_s += step_s
            if self._waited_s >= _EVERY_S:
                self._waited_s = 0.0
                self._attend()

    def utc(self) -> datetime:
        """Return the clock's date and time."""
        return self._clock.utc()
