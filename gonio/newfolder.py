"""A folder that is whole or not there: made aside, synced, renamed."""

from __future__ import annotations

import contextlib
import errno
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from gonio.errors import BadInputError, StorageError
from gonio.files import sync_file

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextlib.contextmanager
def new_folder(root: Path, remedy: str) -> Iterator[Path]:
    """Yield an empty folder that is put in place once it is filled; an existing one is not touched.

    Parameters
    ----------
    root
        Where; parents are made where they are missing. An empty folder may be there.
    remedy
        What to do when there is one that is not.

    Raises
    ------
    gonio.errors.BadInputError
        When `root` exists and is not an empty folder.
    gonio.errors.StorageError
        When the operating system refuses.
    """
    if root.exists() and (not root.is_dir() or any(root.iterdir())):
        raise _exists(root, remedy)
    try:
        root.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(
            dir=root.parent, prefix=f".{root.name}.", ignore_cleanup_errors=True
        ) as aside:
            folder = Path(aside) / "whole"
            folder.mkdir()
            yield folder
            # a power cut after the rename must find all of it below the new name
            for path in (folder, *folder.rglob("*")):
                sync_file(path)
            _move(folder, root, remedy)
    except OSError as error:
        raise StorageError.from_os(root, error) from error
    except KeyboardInterrupt as stop:
        stop.args = stop.args or (f"nothing of {root} is kept",)
        raise


def _move(aside: Path, root: Path, remedy: str) -> None:
    try:
        aside.rename(root)
    except OSError as error:
        if error.errno in (errno.ENOTEMPTY, errno.EEXIST):
            raise _exists(root, remedy) from None
        raise
    sync_file(root.parent)


def _exists(root: Path, remedy: str) -> BadInputError:
    return BadInputError(f"{root}: exists already and is never overwritten; {remedy}")
