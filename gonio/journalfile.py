"""The file of a journal: a table in SQLite, written ahead, that refuses to change or lose a row."""

from __future__ import annotations

import sqlite3
from typing import TYPE_CHECKING, Final

from gonio.errors import BadFileError

if TYPE_CHECKING:
    from pathlib import Path

NO_JOURNAL: Final = "give the folder of a session that gonio capture made"
"""What to do about a file that is no journal."""

_TABLE = """
CREATE TABLE IF NOT EXISTS event (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    at_s REAL NOT NULL,
    utc TEXT NOT NULL,
    kind TEXT NOT NULL,
    data TEXT NOT NULL,
    sha256 TEXT
);
CREATE TRIGGER IF NOT EXISTS event_is_never_changed BEFORE UPDATE ON event
BEGIN SELECT RAISE(ABORT, 'the journal is append-only'); END;
CREATE TRIGGER IF NOT EXISTS event_is_never_deleted BEFORE DELETE ON event
BEGIN SELECT RAISE(ABORT, 'the journal is append-only'); END;
"""


def connect_writing(path: Path, *, synced: bool = True) -> sqlite3.Connection:
    """Open a journal to add to it, or make it; one of before rows had hashes gets room for them."""
    connection = sqlite3.connect(path, isolation_level=None)
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute(f"PRAGMA synchronous = {'FULL' if synced else 'OFF'}")
    connection.executescript(_TABLE)
    if not has_hashes(connection):
        connection.execute("ALTER TABLE event ADD COLUMN sha256 TEXT")
    return connection


def connect_reading(path: Path) -> sqlite3.Connection:
    """Open a journal to be read, leaving nothing beside it.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing.
    """
    if not path.is_file():
        raise BadFileError(path, "is no file" if path.exists() else "no such file", NO_JOURNAL)
    ahead = path.with_name(f"{path.name}-wal")
    # a killed capture leaves events there; without them, SQLite needs no files of its own beside it
    is_whole = not ahead.is_file() or not ahead.stat().st_size
    mode = "mode=ro&immutable=1" if is_whole else "mode=ro"
    connection = sqlite3.connect(f"{path.resolve().as_uri()}?{mode}", uri=True)
    if not connection.execute("SELECT 1 FROM sqlite_master WHERE name = 'event'").fetchone():
        # whatever ended the capture came before its first event
        connection.close()
        connection = sqlite3.connect(":memory:")
        connection.executescript(_TABLE)
    return connection


def has_hashes(connection: sqlite3.Connection) -> bool:
    """Tell whether a journal's rows can state hashes."""
    columns = connection.execute("SELECT name FROM pragma_table_info('event')")
    return ("sha256",) in columns.fetchall()
