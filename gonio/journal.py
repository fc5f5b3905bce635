"""The journal of a session: an append-only list of what happened, safe against a dying host."""

from __future__ import annotations

import json
import sqlite3
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from pydantic import AwareDatetime, Field, ValidationError

from gonio.errors import BadFileError, StorageError
from gonio.journalfile import NO_JOURNAL, connect_reading, connect_writing, has_hashes
from gonio.rowchain import START, Row, break_in, followed, row_sha256
from gonio.validation import Document, describe

if TYPE_CHECKING:
    from collections.abc import Iterator
    from datetime import datetime
    from pathlib import Path
    from types import TracebackType

    from gonio.clock import Clock

_INSERT = "INSERT INTO event (id, at_s, utc, kind, data, sha256) VALUES (?, ?, ?, ?, ?, ?)"
_MEND = "put a copy of the file back, or measure anew into another folder"

D = TypeVar("D", bound=Document)
Role = Literal["dark", "white", "shot"]


class FrameRecord(Document):
    """One raw frame that is safely on the disk.

    Attributes
    ----------
    role
        Dark frame, white reference or shot.
    shot_index, attempt
        The plan's shot and which try at it (0 and 1 for dark and white frames).
    repeat
        Which of several frames of one exposure, from 0.
    exposure_s
        The exposure asked for; the frame's own metadata says the true one.
    file, sha256
        Path relative to the session, and the content's hash.
    flux
        Mean of each of the eleven lamps over the exposure, 1 = 25 deg C and 700 mA.
    view_theta_deg, view_phi_deg, light_theta_deg, light_phi_deg
        Angles by the encoders at the time of the exposure.
    """

    role: Role
    shot_index: int = Field(ge=0)
    attempt: int = Field(ge=1)
    repeat: int = Field(ge=0)
    exposure_s: float = Field(gt=0)
    file: str
    sha256: str
    flux: tuple[float, ...] = Field(min_length=11, max_length=11)
    view_theta_deg: float
    view_phi_deg: float
    light_theta_deg: float
    light_phi_deg: float

    @property
    def key(self) -> tuple[str, int, int, float]:
        """What makes a frame the one that was wanted: role, shot, repeat and exposure."""
        return (self.role, self.shot_index, self.repeat, self.exposure_s)


class Rejection(Document):
    """A frame that is of no use, by its file, and why."""

    file: str
    problem: str


class Event(Document):
    """One line of the journal."""

    id: int
    at_s: float
    utc: AwareDatetime
    kind: str
    data: dict[str, Any]


class Journal:
    """SQLite in write-ahead mode, every event synced before `append` returns unless told otherwise.

    Parameters
    ----------
    path
        The file.
    writing
        Whether events are to be added; then it is made when missing. Otherwise nothing is written,
        not even beside it, and it may lie where nothing can be.
    synced
        Whether events are to outlive a power cut; those of a rehearsal need not.

    Raises
    ------
    BadFileError
        When it is missing though it is to be read, or is no journal.
    StorageError
        When the operating system refuses, as on a full disk.
    """

    def __init__(self, path: Path, *, writing: bool = False, synced: bool = True) -> None:
        self.path = path
        try:
            self._connection = (
                connect_writing(path, synced=synced) if writing else connect_reading(path)
            )
        except sqlite3.OperationalError as error:
            # of SQLite's errors the one for what the operating system refused, a full disk first
            remedy = (
                "another program holds it; close that" if "locked" in str(error)
                else "check the disk's free space, the folder and its permissions" if writing
                else "copy the session to a folder that can be written, and use the copy"
            )  # fmt: skip
            raise StorageError(f"{path}: cannot be opened ({error}); {remedy}") from None
        except sqlite3.DatabaseError as error:
            raise BadFileError(path, f"is not a journal ({error})", NO_JOURNAL) from None

    def __enter__(self) -> Journal:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._connection.close()

    def append(self, clock: Clock, kind: str, **data: Any) -> None:
        """Add an event, on the disk when this returns.

        Raises
        ------
        StorageError
            When it cannot be written (disk full).
        """
        self._insert(clock.now(), clock.utc(), kind, data)

    def append_frame(self, clock: Clock, frame: FrameRecord) -> None:
        """Add a frame whose file is already synced (errors as for `append`)."""
        self.append(clock, "frame", **frame.model_dump(mode="json"))

    def reject(self, file: str, problem: str) -> None:
        """Note that a frame is of no use, so that a resume takes it again (errors as `append`)."""
        # no clock runs after the capture: the note is as old as the last event
        last = max(self.events(), key=lambda event: event.id)
        self._insert(last.at_s, last.utc, "rejected", {"file": file, "problem": problem})

    def _insert(self, at_s: float, utc: datetime, kind: str, data: dict[str, Any]) -> None:
        text = json.dumps(data, sort_keys=True)
        try:
            row = Row(self._written() + 1, float(at_s), utc.isoformat(), kind, text)
            row = row._replace(sha256=row_sha256(self._last_sha256(), row))
            self._connection.execute(_INSERT, row)
        except sqlite3.Error as error:
            raise StorageError(
                f"{self.path}: cannot be written ({error}); free some space and resume"
            ) from error

    def check_chain(self) -> None:
        """Refuse a journal whose rows are not all there as they were written.

        Raises
        ------
        BadFileError
            Naming the first record that was changed, moved or removed, or where it is damaged.
        """
        try:
            problem = break_in(self._rows(), self._written())
        except sqlite3.DatabaseError as error:
            problem = f"is damaged ({error})"
        if problem is not None:
            raise BadFileError(self.path, problem, _MEND)

    def _rows(self) -> Iterator[Row]:
        sha256 = "sha256" if has_hashes(self._connection) else "NULL"
        query = f"SELECT id, at_s, utc, kind, data, {sha256} FROM event ORDER BY id"
        return map(Row._make, self._connection.execute(query))

    def _written(self) -> int:
        """Return how many rows were ever written, whatever became of them."""
        row = self._connection.execute(
            "SELECT seq FROM sqlite_sequence WHERE name = 'event'"
        ).fetchone()
        return row[0] if row else 0

    def _last_sha256(self) -> str:
        # read anew each time: a reduction between two rounds adds rows through a journal of its own
        query = "SELECT sha256 FROM event ORDER BY id DESC LIMIT 1"
        (stated,) = self._connection.execute(query).fetchone() or (START,)
        if stated is None:  # the last row of a journal of before rows had hashes
            *_, (_, stated) = followed(self._rows())
        return str(stated)

    def events(self, kind: str | None = None, after: int = 0) -> Iterator[Event]:
        """Iterate over the events in order, of one kind or all, beyond the id `after`.

        Raises
        ------
        BadFileError
            When the file is damaged, naming the record.
        """
        query = (
            "SELECT id, at_s, utc, kind, data FROM event "
            "WHERE id > ? AND (? IS NULL OR kind = ?) ORDER BY id"
        )
        place = "before its first record"
        try:
            for row in self._connection.execute(query, (after, kind, kind)):
                event = self._event(*row)
                place = f"after record {event.id}"
                yield event
        except sqlite3.DatabaseError as error:
            raise BadFileError(self.path, f"is damaged {place} ({error})", _MEND) from None

    def frames(self) -> list[FrameRecord]:
        """Return the frames recorded so far, in order (errors as for `events`)."""
        return [self.frame_of(event) for event in self.events("frame")]

    def frame_of(self, event: Event) -> FrameRecord:
        """Return the frame that an event of that kind records (errors as for `events`)."""
        return self._checked(FrameRecord, event.data, event.id)

    def rejected(self) -> set[str]:
        """Return the files of the frames that are of no use (errors as for `events`)."""
        events = self.events("rejected")
        return {self._checked(Rejection, event.data, event.id).file for event in events}

    def _event(self, number: int, at_s: Any, utc: Any, kind: Any, text: Any) -> Event:
        try:
            data = json.loads(text)
        except (TypeError, ValueError, RecursionError) as error:
            problem = f"record {number} is damaged: data is not JSON ({error})"
            raise BadFileError(self.path, problem, _MEND) from None
        row = {"id": number, "at_s": at_s, "utc": utc, "kind": kind, "data": data}
        return self._checked(Event, row, number)

    def _checked(self, model: type[D], data: dict[str, Any], number: int) -> D:
        try:
            return model.model_validate(data)
        except ValidationError as error:
            problem = f"record {number} is damaged: {describe(error)}"
            raise BadFileError(self.path, problem, _MEND) from None
