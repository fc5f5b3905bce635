"""The journal of a session: an append-only list of what happened, safe against a dying host."""

from __future__ import annotations

import json
import sqlite3
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from gonio.errors import BadFileError, StorageError
from gonio.validation import Document, check

if TYPE_CHECKING:
    from collections.abc import Iterator
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


@dataclass(frozen=True)
class Event:
    """One line of the journal."""

    id: int
    at_s: float
    utc: str
    kind: str
    data: dict[str, Any]


class Journal:
    """SQLite in write-ahead mode, every event synced before `append` returns.

    Parameters
    ----------
    path
        The file; made when missing unless `must_exist`.

    Raises
    ------
    BadFileError
        When it is missing though it must exist, or is no journal.
    StorageError
        When the operating system refuses, as on a full disk.
    """

    def __init__(self, path: Path, *, must_exist: bool = False) -> None:
        self.path = path
        if must_exist and not path.is_file():
            raise BadFileError(path, "no such file", _REMEDY)
        try:
            self._connection = sqlite3.connect(path, isolation_level=None)
            self._connection.execute("PRAGMA journal_mode = WAL")
            self._connection.execute("PRAGMA synchronous = FULL")
            self._connection.execute(_TABLE)
        except sqlite3.OperationalError as error:
            # of SQLite's errors the one for what the operating system refused, a full disk first
            raise StorageError(
                f"{path}: cannot be opened ({error}); check the disk's free space, the folder and "
                "its permissions"
            ) from None
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
        row = (clock.now(), clock.utc().isoformat(), kind, json.dumps(data, sort_keys=True))
        self._insert(row)

    def _insert(self, row: tuple[float, str, str, str]) -> None:
        try:
            self._connection.execute(
                "INSERT INTO event (at_s, utc, kind, data) VALUES (?, ?, ?, ?)", row
            )
        except sqlite3.Error as error:
            raise StorageError(
                f"{self.path}: cannot be written ({error}); free some space and resume"
            ) from error

    def reject(self, file: str, problem: str) -> None:
        """Note that a frame is of no use, so that a resume takes it again (errors as `append`)."""
        # no clock runs after the capture: the note is as old as the last event
        last = max(self.events(), key=lambda event: event.id)
        self._insert(
            (last.at_s, last.utc, "rejected", json.dumps({"file": file, "problem": problem}))
        )

    def append_frame(self, clock: Clock, frame: FrameRecord) -> None:
        """Add a frame whose file is already synced (errors as for `append`)."""
        self.append(clock, "frame", **frame.model_dump(mode="json"))

    def events(self, kind: str | None = None) -> Iterator[Event]:
        """Iterate over the events in order, of one kind or all.

        Raises
        ------
        BadFileError
            When the file is damaged.
        """
        query = (
            "SELECT id, at_s, utc, kind, data FROM event WHERE ? IS NULL OR kind = ? ORDER BY id"
        )
        try:
            for number, at_s, utc, name, data in self._connection.execute(query, (kind, kind)):
                yield Event(number, at_s, utc, name, json.loads(data))
        except (sqlite3.DatabaseError, ValueError) as error:
            raise BadFileError(self.path, f"is damaged ({error})", _REMEDY) from None

    def frames(self) -> list[FrameRecord]:
        """Return the frames recorded so far, in order (errors as for `events`)."""
        events = self.events("frame")
        return [check(FrameRecord, event.data, self.path, _REMEDY) for event in events]

    def rejected(self) -> set[str]:
        """Return the files of the frames that are of no use (errors as for `events`)."""
        return {str(event.data["file"]) for event in self.events("rejected")}
