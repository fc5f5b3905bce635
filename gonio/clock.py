"""Time as something passed in: the system's for rigs, a virtual one for the twin."""

from __future__ import annotations

import heapq
import itertools
import time
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable

_VIRTUAL_EPOCH = datetime(2000, 1, 1, tzinfo=UTC)


class Clock(Protocol):
    """What drivers wait on."""

    def now(self) -> float:
        """Return monotonic seconds from an arbitrary start."""

    def sleep(self, seconds: float) -> None:
        """Let `seconds` pass; negative values pass none."""

    def utc(self) -> datetime:
        """Return the date and time, in UTC, for records."""


class SystemClock:
    """The machine's own time.

    Parameters
    ----------
    start
        Seconds that count as passed already (a resumed session goes on).
    """

    def __init__(self, start: float = 0.0) -> None:
        self._zero_s = time.monotonic() - start

    def now(self) -> float:
        """Return the seconds passed; no change of the date moves them."""
        return time.monotonic() - self._zero_s

    def sleep(self, seconds: float) -> None:
        """Sleep for real."""
        time.sleep(max(seconds, 0.0))

    def utc(self) -> datetime:
        """Return the system's date and time."""
        return datetime.now(UTC)


class VirtualClock:
    """Time that passes only when somebody sleeps; a night of scanning takes seconds.

    Parameters
    ----------
    start
        Seconds already passed since the virtual epoch, 2000-01-01 (a resumed session goes on).
    """

    def __init__(self, start: float = 0.0) -> None:
        self._now = start
        self._alarms: list[tuple[float, int, Callable[[], None]]] = []
        self._number = itertools.count()

    def now(self) -> float:
        """Return the virtual seconds passed."""
        return self._now

    def sleep(self, seconds: float) -> None:
        """Advance by `seconds` at once, doing on the way what `call_at` asked for."""
        until = self._now + max(seconds, 0.0)
        while self._alarms and self._alarms[0][0] <= until:
            when, _, action = heapq.heappop(self._alarms)
            self._now = max(self._now, when)
            action()
        self._now = until

    def call_at(self, when: float, action: Callable[[], None]) -> None:
        """Call `action`, which must not sleep, once when the time `when` is passed."""
        heapq.heappush(self._alarms, (when, next(self._number), action))

    def utc(self) -> datetime:
        """Return the virtual date and time."""
        return _VIRTUAL_EPOCH + timedelta(seconds=self._now)
