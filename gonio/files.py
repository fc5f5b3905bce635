"""Files that are whole or not there: write aside, sync, rename; hash; canonical JSON."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
import shutil
from typing import TYPE_CHECKING, Any

from gonio.errors import StorageError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

_BLOCK = 1 << 20
_ROOM_BYTES = 1 << 24
# how every file of SQLite begins
_SQLITE = b"SQLite format 3\0"


def canonical_json(value: Any) -> bytes:
    """Serialise to the one byte string that hashes are taken of: sorted keys, no spaces.

    Raises
    ------
    ValueError
        For NaN and infinities, which JSON does not have.
    """
    text = json.dumps(
        value, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False
    )
    return _utf8(text)


def sha256_bytes(data: bytes) -> str:
    """Return the SHA-256 of `data` in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def sha256_file(path: Path) -> str:
    """Return the SHA-256 of a file's content in hexadecimal, read in blocks."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(_BLOCK):
            digest.update(block)
    return digest.hexdigest()


def sync_file(path: Path) -> None:
    """Force a file's content, or a folder's entries, to the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_with(path: Path, write: Callable[[Path], None]) -> None:
    """Let `write` fill a file beside `path`, sync it and rename it into place.

    Raises
    ------
    StorageError
        When the operating system refuses; `path` is then as it was before. Also when `path` is
        there and no file: a rename would put one in the place of a device or a pipe.
    """
    if path.exists() and not path.is_file():
        raise StorageError(f"{path}: is there and is no file; give another name")
    _refuse_journal(path)
    aside = path.with_name(f".{path.name}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(aside)
        sync_file(aside)
        aside.replace(path)
        sync_file(path.parent)
    except OSError as error:
        raise StorageError.from_os(path, error) from error
    finally:
        with contextlib.suppress(OSError):
            aside.unlink(missing_ok=True)


def _refuse_journal(path: Path) -> None:
    """Refuse to put something in the place of a journal, without which a session is lost."""
    try:
        with path.open("rb") as there:
            is_journal = there.read(len(_SQLITE)) == _SQLITE
    except OSError:
        return
    if is_journal:
        raise StorageError(f"{path}: is a database, as a session's journal is; give another name")


def write_bytes(path: Path, data: bytes) -> None:
    """Write `data` to `path`, whole or not at all (see `write_with`)."""

    def write(aside: Path) -> None:
        aside.write_bytes(data)

    write_with(path, write)


def write_json(path: Path, value: Any) -> None:
    """Write `value` as readable JSON with sorted keys, whole or not at all."""
    text = json.dumps(value, sort_keys=True, indent=1, ensure_ascii=False, allow_nan=False)
    write_bytes(path, _utf8(text + "\n"))


def _utf8(text: str) -> bytes:
    # half a surrogate pair, as from a name that is not text, becomes the escape JSON has for it
    return text.encode("utf-8", "backslashreplace")


def move_into(source: Path, target: Path) -> None:
    """Move `source` to `target`, whole or not at all, syncing the file and both folders."""
    try:
        sync_file(source)
        _replace(source, target)
        for folder in {source.parent, target.parent}:
            sync_file(folder)
    except OSError as error:
        raise StorageError.from_os(target, error) from error


def _replace(source: Path, target: Path) -> None:
    try:
        source.replace(target)
    except OSError as error:
        if error.errno != errno.EXDEV:
            raise
        # a camera's folder may lie on another disk
        aside = target.with_name(f".{target.name}.part")
        shutil.copyfile(source, aside)
        sync_file(aside)
        aside.replace(target)
        source.unlink()


def check_room(folder: Path) -> None:
    """Refuse, before any work is done, a folder in which nothing could be kept.

    Parameters
    ----------
    folder
        May be missing; then what it would be made in counts. 16 MB must be free.

    Raises
    ------
    StorageError
        Saying what is in the way.
    """
    try:
        nearest = folder.absolute()
        while not nearest.exists():
            nearest = nearest.parent
        if not nearest.is_dir():
            raise _refusal(errno.ENOTDIR)
        if not os.access(nearest, os.W_OK | os.X_OK):
            raise _refusal(errno.EACCES)
        if shutil.disk_usage(nearest).free < _ROOM_BYTES:
            raise _refusal(errno.ENOSPC)
    except OSError as error:
        raise StorageError.from_os(folder, error) from error


def make_folder(path: Path) -> None:
    """Make a folder where there is none; its name is synced to the disk.

    Raises
    ------
    StorageError
        When the operating system refuses.
    """
    if path.is_dir():
        return
    try:
        path.mkdir()
        sync_file(path.parent)
    except OSError as error:
        raise StorageError.from_os(path, error) from error


def remove_file(path: Path) -> None:
    """Remove a file, if it is there.

    Raises
    ------
    StorageError
        When the operating system refuses.
    """
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise StorageError.from_os(path, error) from error


def _refusal(code: int) -> OSError:
    return OSError(code, os.strerror(code))
