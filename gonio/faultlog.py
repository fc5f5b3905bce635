"""The faults in a journal: what happened, and what was done about it."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.journal import Journal


@dataclass(frozen=True)
class FaultRecord:
    """One fault.

    Attributes
    ----------
    at_s
        When, in the session's seconds.
    what
        What happened, as the driver said it.
    did
        What was done about it.
    """

    at_s: float
    what: str
    did: str

    @property
    def where(self) -> str:
        """The device: an axis, a unit of the bus, the lamps, or the camera by one of its frames."""
        place = self.what.partition(":")[0].partition(",")[0]
        return "camera" if place.endswith(".dng") else place


def faults_of(journal: Journal) -> list[FaultRecord]:
    """Return the faults of a session, oldest first (errors as for `Journal.events`)."""
    return [
        FaultRecord(event.at_s, str(event.data.get("what")), str(event.data.get("did")))
        for event in journal.events("fault")
    ]


def spoken(faults: Sequence[FaultRecord]) -> str:
    """Return how many there were and where, the place of most first."""
    places = Counter(fault.where for fault in faults).most_common()
    return ", ".join(f"{count} x {place}" for place, count in places)
