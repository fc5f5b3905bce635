"""What a session's journal says so far, read on from where it was read last."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from gonio.faultlog import FaultRecord

if TYPE_CHECKING:
    from datetime import datetime

    from gonio.intact import FrameKey
    from gonio.journal import Event, FrameRecord
    from gonio.session import Session

_PHASES = {
    "begun": "starting",
    "homed": "calibrating",
    "paused": "paused",
    "resumed": "measuring",
    "stopped": "stopped",
    "finished": "finished",
}


@dataclass
class Told:
    """What events told.

    Attributes
    ----------
    events
        All of them.
    frames
        The newest of each frame that is of use.
    faults
        With their dates, oldest first.
    last_frame
        The id of its event, its date and itself.
    phase
        What the capture does: waiting, starting, calibrating, measuring, paused, stopped, finished.
    reason
        What stopped it.
    by
        What it is measured by, where that is another program than gonio.
    target
        Of an adaptive capture under way; None without one.
    """

    events: list[Event] = field(default_factory=list)
    frames: dict[FrameKey, FrameRecord] = field(default_factory=dict)
    faults: list[tuple[datetime, FaultRecord]] = field(default_factory=list)
    last_frame: tuple[int, datetime, FrameRecord] | None = None
    phase: str = "waiting"
    reason: str = ""
    by: str = ""
    target: float | None = None

    @property
    def is_over(self) -> bool:
        """Whether no more is to be expected: an adaptive capture finishes each of its rounds."""
        return self.phase == "stopped" or (self.phase == "finished" and self.target is None)

    def hear(self, event: Event, frame: FrameRecord | None = None) -> None:
        """Take in the next event, with the frame that it records, if it does."""
        self.events.append(event)
        self.phase = _PHASES.get(event.kind, self.phase)
        if frame is not None:
            self._frame(event, frame)
        elif event.kind == "rejected":
            file = event.data.get("file")
            self.frames = {key: each for key, each in self.frames.items() if each.file != file}
        elif event.kind == "fault":
            what, did = str(event.data.get("what")), str(event.data.get("did"))
            self.faults.append((event.utc, FaultRecord(event.at_s, what, did)))
        elif event.kind == "begun":
            self.by = str(event.data.get("by", ""))
        elif event.kind == "stopped":
            self.reason = str(event.data.get("reason", ""))
        elif event.kind in ("adaptive", "adaptive ended"):
            self.target = event.data.get("until")

    def _frame(self, event: Event, record: FrameRecord) -> None:
        self.frames[record.key] = record
        self.last_frame = (event.id, event.utc, record)
        self.phase = "measuring" if record.role == "shot" else "calibrating"


class Following:
    """Reads a journal beside its writer, which it never keeps waiting.

    It is opened anew for each look, and read only: nothing of it stays open, so that the capture
    can close and another one open it.

    Parameters
    ----------
    session
        Whose journal; there may be none yet.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._told = Told()

    def look(self) -> Told:
        """Return all that is told so far.

        Raises
        ------
        gonio.errors.GonioError
            When the journal cannot be read, is locked, or is damaged.
        """
        if not self._session.journal_path.is_file():
            self._told = Told()
            return self._told
        with self._session.journal() as journal:
            if not self._goes_on(next(journal.events(after=self._heard - 1), None)):
                self._told = Told()
            for event in journal.events(after=self._heard):
                frame = journal.frame_of(event) if event.kind == "frame" else None
                self._told.hear(event, frame)
        return self._told

    @property
    def _heard(self) -> int:
        return self._told.events[-1].id if self._told.events else 0

    def _goes_on(self, event: Event | None) -> bool:
        """Whether the last event heard is still there: another session may lie in its place."""
        return not self._told.events or event == self._told.events[-1]
