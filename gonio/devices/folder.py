"""A folder on this machine into which a tethered camera puts its files."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from gonio.errors import DeviceFaultError, StorageError
from gonio.files import move_into

if TYPE_CHECKING:
    from pathlib import Path

_PATTERN = "frame_*.dng"


class LocalFolder:
    """A `gonio.transports.FrameFolder` in the file system.

    Parameters
    ----------
    path
        The folder; it must exist.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    def names(self) -> set[str]:
        """Return the names of the whole frames that are there now."""
        return {path.name for path in self._path.glob(_PATTERN)}

    def take(self, name: str, target: Path) -> None:
        """Move a frame out to `target`, on the same disk, synced.

        Raises
        ------
        gonio.errors.StorageError
            When it cannot be moved.
        """
        move_into(self._path / name, target)

    def set_aside(self) -> int:
        """Move all files into a new folder `aside_000`, `aside_001`, ... beside them.

        Returns
        -------
        int
            How many files were moved.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When the folder is not there.
        gonio.errors.StorageError
            When they cannot be moved.
        """
        if not self._path.is_dir():
            raise DeviceFaultError(
                f"{self._path}: no such folder; check the camera's tethering and folder in the "
                "rig file"
            )
        files = [path for path in self._path.iterdir() if path.is_file()]
        if files:
            self._move(files)
        return len(files)

    def _move(self, files: list[Path]) -> None:
        names = (self._path / f"aside_{number:03d}" for number in itertools.count())
        aside = next(path for path in names if not path.exists())
        try:
            aside.mkdir()
            for path in files:
                path.replace(aside / path.name)
        except OSError as error:
            raise StorageError.from_os(aside, error) from error
