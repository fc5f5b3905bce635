"""Foreign files are read whole, so their size is looked at first."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from gonio.errors import BadFileError
from gonio.words import size as size_in_words

if TYPE_CHECKING:
    from pathlib import Path

LARGEST_FILE: Final = 1 << 28
"""In bytes; the largest files of the databases are an eighth of it."""

_HEAD = 1 << 16
_REMEDY = "give a file that gonio reads (gonio import --help lists them)"


def head_of(path: Path) -> tuple[bytes, int]:
    """Return the first 64 kB of a file and its size.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing, no file, unreadable, empty or larger than 268 MB.
    """
    head, size = _read(path, _HEAD)
    return head, size


def read_whole(path: Path) -> bytes:
    """Return a file's content; refuses as `head_of`."""
    return _read(path, LARGEST_FILE)[0]


def _read(path: Path, count: int) -> tuple[bytes, int]:
    # a device or a pipe may never end
    if not path.exists():
        raise BadFileError(path, "no such file", _REMEDY)
    if not path.is_file():
        raise BadFileError(path, "is no file", _REMEDY)
    try:
        with path.open("rb") as file:
            size = path.stat().st_size
            if size > LARGEST_FILE:
                limit = size_in_words(LARGEST_FILE)
                problem = f"is {size_in_words(size)} long, more than {limit}"
                raise BadFileError(path, problem, _REMEDY)
            content = file.read(min(count, LARGEST_FILE))
    except OSError as error:
        raise BadFileError(path, f"cannot be read ({error.strerror})", _REMEDY) from None
    if not content:
        raise BadFileError(path, "is empty", _REMEDY)
    return content, size
