"""What a session's journal tells of its capture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.adaptive import ending, rig_time
from gonio.capture.usage import Usage, usages_of
from gonio.faultlog import faults_of, spoken

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.journal import Event, Journal
    from gonio.session import Session


@dataclass(frozen=True)
class Captured:
    """A capture.

    Attributes
    ----------
    day
        When it began.
    rig_s
        Seconds that the rig worked; the time between runs is not counted.
    usage
        What they went into, in words; empty where that is not known.
    faults
        The faults that it met, in words; empty where it met none.
    ending
        What ended it where it was adaptive; None where it was not, or goes on.
    finished_s
        The rig's time at which each plan was done, by the plan's hash.
    last_deviation
        Where it was adaptive, the mean posterior standard deviation at its end.
    """

    day: str
    rig_s: float
    usage: str
    faults: str
    ending: str | None
    finished_s: dict[str, float]
    last_deviation: float | None

    @classmethod
    def of(cls, session: Session | None) -> Captured | None:
        """Read a session's journal; None where there is none, or nothing in it."""
        if session is None or not session.journal_path.is_file():
            return None
        with session.journal() as journal:
            events = list(journal.events())
            return cls._of_journal(journal, events) if events else None

    @classmethod
    def _of_journal(cls, journal: Journal, events: Sequence[Event]) -> Captured:
        runs = usages_of(journal)
        ends = [event.data for event in events if event.kind == "adaptive ended"]
        return cls(
            day=min(event.utc for event in events).date().isoformat(),
            rig_s=rig_time(events),
            usage=Usage.sum(runs).sentence if runs else "",
            faults=spoken(faults_of(journal)),
            ending=ending(journal),
            finished_s=_finished_s(events),
            last_deviation=ends[-1]["deviation"] if ends else None,
        )


def _finished_s(events: Sequence[Event]) -> dict[str, float]:
    done: dict[str, float] = {}
    plan = ""
    for place, event in enumerate(events, start=1):
        if event.kind == "begun":
            plan = str(event.data.get("plan"))
        elif event.kind == "finished":
            done[plan] = rig_time(events[:place])
    return done
