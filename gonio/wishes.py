"""What whoever watches a capture wishes of it: a file in its session that it looks for."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Final, Literal

from gonio.errors import BadFileError, StorageError
from gonio.files import remove_file, write_json
from gonio.validation import Document, check, parse_json, read_text

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

Want = Literal["pause", "stop"]

_NAME: Final = "wish.json"
_REMEDY: Final = "delete it"


class _Wish(Document):
    want: Want


def wish(root: Path, want: Want) -> None:
    """Leave a wish in a session's folder, in place of the one that is there.

    Raises
    ------
    gonio.errors.StorageError
        When it cannot be written.
    """
    write_json(root / _NAME, {"want": want})


def wished(root: Path) -> Want | None:
    """Return what is wished of the capture in a session's folder; None: that it goes on.

    A file that says nothing known is no wish: it must not end a night.
    """
    path = root / _NAME
    if not path.is_file():
        return None
    try:
        return check(_Wish, parse_json(read_text(path, _REMEDY), path, _REMEDY), path, _REMEDY).want
    except BadFileError:
        return None


def forget(root: Path) -> None:
    """Take the wish away (errors as `wish`)."""
    remove_file(root / _NAME)


@contextlib.contextmanager
def heeding(root: Path) -> Iterator[None]:
    """Capture meanwhile; wishes of before and after are of no capture, and are taken away."""
    forget(root)
    try:
        yield
    finally:
        with contextlib.suppress(StorageError):
            forget(root)
