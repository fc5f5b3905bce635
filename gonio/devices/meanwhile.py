"""A clock whose waits are made use of: something else is looked after while they last."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from datetime import datetime

    from gonio.clock import Clock

_EVERY_S = 0.02


class MeanwhileClock:
    """A `gonio.clock.Clock` with an errand to run while somebody waits on it.

    Parameters
    ----------
    clock
        The time.

    Attributes
    ----------
    errand
        Called every 20 ms of waiting until it returns True, then forgotten; None where there is
        nothing to do. It neither waits nor raises, and what it takes is taken off the wait.
    """

    def __init__(self, clock: Clock) -> None:
        self.errand: Callable[[], bool] | None = None
        self._clock = clock

    def now(self) -> float:
        """Return the clock's time."""
        return self._clock.now()

    def sleep(self, seconds: float) -> None:
        """Let `seconds` pass."""
        until_s = self._clock.now() + seconds
        while self.errand is not None and (left_s := until_s - self._clock.now()) > 0:
            self._clock.sleep(min(left_s, _EVERY_S))
            if self.errand():
                self.errand = None
        self._clock.sleep(until_s - self._clock.now())

    def utc(self) -> datetime:
        """Return the clock's date and time."""
        return self._clock.utc()
