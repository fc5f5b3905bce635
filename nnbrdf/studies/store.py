"""`results.jsonl`: one line a finished training, so that a study goes on where it was stopped."""

from __future__ import annotations

import fcntl
import json
import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

from pydantic import ValidationError

from gonio.errors import BadFileError, BadInputError, StorageError
from gonio.files import sync_file
from gonio.validation import describe
from nnbrdf.studies.job import Outcome

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from io import FileIO
    from pathlib import Path

RESULTS_NAME = "results.jsonl"
_REMEDY = "move the file away to begin the study anew"


def read_results(folder: Path) -> dict[str, Outcome]:
    """Return the outcomes of a study's folder by the keys of their jobs.

    A last line that was cut short does not count.

    Raises
    ------
    gonio.errors.BadFileError
        When any other line is no outcome.
    """
    path = folder / RESULTS_NAME
    if not path.exists():
        return {}
    try:
        lines = path.read_bytes().split(b"\n")
    except OSError as error:
        raise BadFileError(path, f"cannot be read ({error.strerror})", _REMEDY) from None
    outcomes = [_parse(path, number, line) for number, line in enumerate(lines[:-1], start=1)]
    return {outcome.job.key: outcome for outcome in outcomes}


@contextmanager
def appending(folder: Path) -> Iterator[Callable[[Outcome], None]]:
    """Yield what to call with each outcome; a line is on the disk before the call returns.

    Raises
    ------
    gonio.errors.StorageError
        When the operating system refuses.
    """
    path = folder / RESULTS_NAME
    with _refused(path):
        folder.mkdir(parents=True, exist_ok=True)
        # what is refused when it is written must not come again, and bare, when the file is closed
        file = path.open("ab", buffering=0)
    with file:
        with _refused(path):
            _hold(file, folder)
            sync_file(folder)
            _drop_cut_line(path)

        def append(outcome: Outcome) -> None:
            with _refused(path):
                _write(file, json.dumps(outcome.row()).encode() + b"\n")
                os.fsync(file.fileno())

        # what else is refused meanwhile is not this file's
        yield append


@contextmanager
def _refused(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise StorageError.from_os(path, error) from error


def _write(file: FileIO, line: bytes) -> None:
    """Write a line whole; a system may take only a part of it at once."""
    while line:
        line = line[file.write(line) :]


def _hold(file: FileIO, folder: Path) -> None:
    """Hold the file against other processes; the lock goes with it."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise BadInputError(
            f"{folder}: another study writes its results here; wait for it, or give another -o"
        ) from None


def _parse(path: Path, number: int, line: bytes) -> Outcome:
    try:
        return Outcome.from_row(json.loads(line))
    except ValidationError as error:
        problem = describe(error)
    except (ValueError, RecursionError) as error:
        problem = str(error)
    remedy = f"delete line {number}, and what it stood for is trained again"
    raise BadFileError(path, f"line {number} is no outcome ({problem})", remedy)


def _drop_cut_line(path: Path) -> None:
    with path.open("rb+") as file:
        content = file.read()
        file.truncate(content.rfind(b"\n") + 1)
