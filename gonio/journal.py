"""The journal of a session: an append-only list of what happened, safe against a dying host."""

from __future__ import annotations

import json
import sqlite3
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from pydantic import AwareDatetime, Field, ValidationError

from gonio.errors import BadFileError, StorageError
from gonio.validation import Document, describe

if TYPE_CHECKING:
    from collections.abc import Iterator
    from datetime import datetime
    from pathlib import Path
    from types import TracebackType

    from gonio.clock import Clock

_TABLE = """
CREATE TABLE IF NOT EXISTS event (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    at_s REAL NOT NULL,
    utc TEXT NOT NULL,
    kind TEXT NOT NULL,
    data TEXT NOT NULL
)
"""
_REMEDY = "give the folder of a session that gonio capture made"
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
    """SQLite in write-ahead mode, every event synced before `append` returns.

    Parameters
    ----------
    path
        The file.
    writing
        Whether events are to be added; then it is made when missing. Otherwise nothing is written,
        not even beside it, and it may lie where nothing can be.

    Raises
    ------
    BadFileError
        When it is missing though it is to be read, or is no journal.
    StorageError
        When the operating system refuses, as on a full disk.
    """

    def __init__(self, path: Path, *, writing: bool = False) -> None:
        self.path = path
        try:
            self._connection = _writer(path) if writing else _reader(path)
        except sqlite3.OperationalError as error:
            # of SQLite's errors the one for what the operating system refused, a full disk first
            remedy = (
                "check the disk's free space, the folder and its permissions" if writing
                else "copy the session to a folder that can be written, and use the copy"
            )  # fmt: skip
            raise StorageError(f"{path}: cannot be opened ({error}); {remedy}") from None
        except sqlite3.DatabaseError as error:
            raise BadFileError(path, f"is not a journal ({error})", _REMEDY) from None

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
        """Add an event and sync it to the disk.

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
        row = (at_s, utc.isoformat(), kind, json.dumps(data, sort_keys=True))
        try:
            self._connection.execute(
                "INSERT INTO event (at_s, utc, kind, data) VALUES (?, ?, ?, ?)", row
            )
        except sqlite3.Error as error:
            raise StorageError(
                f"{self.path}: cannot be written ({error}); free some space and resume"
            ) from error

    def events(self, kind: str | None = None) -> Iterator[Event]:
        """Iterate over the events in order, of one kind or all.

        Raises
        ------
        BadFileError
            When the file is damaged, naming the record.
        """
        query = (
            "SELECT id, at_s, utc, kind, data FROM event WHERE ? IS NULL OR kind = ? ORDER BY id"
        )
        place = "before its first record"
        try:
            for row in self._connection.execute(query, (kind, kind)):
                event = self._event(*row)
                place = f"after record {event.id}"
                yield event
        except sqlite3.DatabaseError as error:
            raise BadFileError(self.path, f"is damaged {place} ({error})", _MEND) from None

    def frames(self) -> list[FrameRecord]:
        """Return the frames recorded so far, in order (errors as for `events`)."""
        return [self._checked(FrameRecord, event.data, event.id) for event in self.events("frame")]

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


def _writer(path: Path) -> sqlite3.Connection:
    connection = sqlite3.connect(path, isolation_level=None)
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = FULL")
    connection.execute(_TABLE)
    return connection


def _reader(path: Path) -> sqlite3.Connection:
    if not path.is_file():
        raise BadFileError(path, "no such file", _REMEDY)
    ahead = path.with_name(f"{path.name}-wal")
    # a killed capture leaves events there; without them, SQLite needs no files of its own beside it
    is_whole = not ahead.is_file() or not ahead.stat().st_size
    mode = "mode=ro&immutable=1" if is_whole else "mode=ro"
    connection = sqlite3.connect(f"{path.resolve().as_uri()}?{mode}", uri=True)
    if not connection.execute("SELECT 1 FROM sqlite_master WHERE name = 'event'").fetchone():
        connection.close()
        raise BadFileError(path, "holds no events yet", "resume the capture")
    return connection
