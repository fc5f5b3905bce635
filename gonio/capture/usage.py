"""What a rig's time went into, and what the same would have taken one thing after the other."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from gonio.validation import Document, check, within
from gonio.words import duration

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from gonio.clock import Clock
    from gonio.journal import Journal

Seconds = Annotated[float, within(0, 1e12)]
_ENDS = ("finished", "stopped")


class Usage(Document):
    """Seconds of a capture by the rig's clock; the first four add up to all of it.

    Attributes
    ----------
    moving_s
        From a pose until in position and still at the next.
    exposing_s
        The shutter was to be open.
    waiting_s
        Nothing happened until a frame's file was in, verified and journaled.
    other_s
        The rest: homing, setting lamps, triggering, warming up, putting faults right.
    hidden_s
        Files were on their way, verified or journaled while something else of it happened.
    """

    moving_s: Seconds = 0.0
    exposing_s: Seconds = 0.0
    waiting_s: Seconds = 0.0
    other_s: Seconds = 0.0
    hidden_s: Seconds = 0.0

    @classmethod
    def sum(cls, usages: Iterable[Usage]) -> Usage:
        """Add up several runs."""
        total = dict.fromkeys(cls.model_fields, 0.0)
        for usage in usages:
            total = {name: seconds + getattr(usage, name) for name, seconds in total.items()}
        return cls(**total)

    @property
    def total_s(self) -> float:
        """All of it."""
        return self.moving_s + self.exposing_s + self.waiting_s + self.other_s

    @property
    def serial_s(self) -> float:
        """What the same would have taken had every file been waited for."""
        return self.total_s + self.hidden_s

    @property
    def utilisation(self) -> float:
        """The share of the time in which the rig moved or exposed; 0 of no time."""
        return self._share_of(self.total_s)

    @property
    def serial_utilisation(self) -> float:
        """The same in serial order."""
        return self._share_of(self.serial_s)

    @property
    def sentence(self) -> str:
        """All of it in words."""
        return (
            f"{self.utilisation:.1%} of {duration(self.total_s)} (moving "
            f"{duration(self.moving_s)}, exposing {duration(self.exposing_s)}; waiting for files "
            f"{duration(self.waiting_s)}, other {duration(self.other_s)}); in serial order "
            f"{self.serial_utilisation:.1%}, {duration(self.hidden_s)} longer"
        )

    def _share_of(self, seconds: float) -> float:
        return (self.moving_s + self.exposing_s) / seconds if seconds else 0.0


class Stopwatch:
    """Adds up what a run's time goes into.

    Parameters
    ----------
    clock
        The rig's; the run begins now.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._began_s = clock.now()
        self._moving_s = self._exposing_s = self._waiting_s = 0.0
        self._watched = _Files()
        self._found = _Files()

    @contextlib.contextmanager
    def moving(self) -> Iterator[None]:
        """Take what is done within for a move, however it ends."""
        began_s = self._clock.now()
        try:
            yield
        finally:
            self._moving_s += self._clock.now() - began_s

    def exposed(self, seconds: float) -> None:
        """Note that the shutter was open."""
        self._exposing_s += seconds

    def fetched(self, took_s: float, waited_s: float, *, watched: bool) -> None:
        """Note that a file was taken in, or given up.

        Parameters
        ----------
        took_s, waited_s
            Since the shutter closed, and how much of that nothing else was done.
        watched
            Whether it was looked for before it came, or at once; else it may have lain there long.
        """
        self._waiting_s += waited_s
        (self._watched if watched else self._found).add(took_s, took_s - waited_s)

    def usage(self) -> Usage:
        """Return the sums so far."""
        known_s = self._moving_s + self._exposing_s + self._waiting_s
        # sums of rounded differences may exceed the difference of the ends by a hair
        other_s = max(self._clock.now() - self._began_s - known_s, 0.0)
        return Usage(
            moving_s=self._moving_s,
            exposing_s=self._exposing_s,
            waiting_s=self._waiting_s,
            other_s=other_s,
            hidden_s=self._watched.hidden_s + self._hidden_of_found_s(),
        )

    def _hidden_of_found_s(self) -> float:
        """Return what files took that were found lying there: at most the mean of those watched."""
        if not self._watched.count:
            return self._found.hidden_s
        each_s = self._watched.took_s / self._watched.count
        return min(self._found.hidden_s, self._found.count * each_s)


@dataclass
class _Files:
    count: int = 0
    took_s: float = 0.0
    hidden_s: float = 0.0

    def add(self, took_s: float, hidden_s: float) -> None:
        self.count += 1
        self.took_s += took_s
        self.hidden_s += hidden_s


def usages_of(journal: Journal) -> list[Usage]:
    """Return what the time of each run of a session went into; of a killed one nothing is known.

    Raises
    ------
    gonio.errors.BadFileError
        When the journal is damaged.
    """
    ends = (event for kind in _ENDS for event in journal.events(kind))
    return [
        check(Usage, event.data["usage"], journal.path, "put a copy of the file back")
        for event in sorted(ends, key=lambda event: event.id)
        if "usage" in event.data
    ]
