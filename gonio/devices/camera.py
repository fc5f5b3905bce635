"""A tethered camera whose files appear in a folder."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from gonio.devices.waiting import wait_until
from gonio.errors import DeviceFaultError

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.clock import Clock
    from gonio.rig import Rig
    from gonio.transports import FrameFolder

_POLL_S = 0.02


class FolderCamera:
    """Takes in the frame that an exposure leaves in a folder.

    Parameters
    ----------
    folder
        Where frames appear.
    rig
        Says how long a file may take.
    clock
        To wait on.
    """

    def __init__(self, folder: FrameFolder, rig: Rig, clock: Clock) -> None:
        self._folder = folder
        self._timeout_s = rig.camera.file_timeout_s
        self._clock = clock

    def prepare(self) -> int:
        """Move what lies in the folder aside; return how many files it was."""
        return self._folder.set_aside()

    def names(self) -> set[str]:
        """Return what is there now: ask before an exposure, and hand it to `fetch` after it."""
        return self._folder.names()

    def fetch(self, frame: int, before: set[str], target: Path) -> None:
        """Wait for a frame, move it to `target`, and check that it is whole.

        Parameters
        ----------
        frame
            The number that the trigger gave it.
        before
            What was in the folder when the trigger was sent; none of it is taken.
        target
            Where it goes, on the same disk; file and folder are synced.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When no file comes in time, or a broken or an old one.
        """
        name = f"frame_{frame:06d}.dng"
        if name in before:
            raise DeviceFaultError(
                f"{name}: lay in the camera's folder before its exposure; the head has restarted "
                "its count: move the file away, then resume"
            )
        there = wait_until(
            self._clock, lambda: name in self._folder.names(), self._timeout_s, _POLL_S
        )
        if not there:
            raise DeviceFaultError(
                f"{name}: did not come within {self._timeout_s:g} s after its exposure; "
                "check the camera, its tethering and folder in the rig file, then resume"
            )
        self._folder.take(name, target)
        check_whole(target)


def check_whole(path: Path) -> None:
    """Refuse a raw file that is shorter than its strips say.

    Raises
    ------
    gonio.errors.DeviceFaultError
        When it is broken.
    """
    import tifffile

    try:
        with tifffile.TiffFile(path) as tiff:
            page = tiff.pages.first
            strips = list(zip(page.dataoffsets, page.databytecounts, strict=True))
    except (OSError, ValueError, LookupError, TypeError, struct.error) as error:
        raise _broken(path, f"is not a raw file ({error})") from None
    size = path.stat().st_size
    if not strips or any(offset + length > size for offset, length in strips):
        need = max((offset + length for offset, length in strips), default=0)
        raise _broken(path, f"has {size} bytes of {need}")


def _broken(path: Path, what: str) -> DeviceFaultError:
    return DeviceFaultError(f"{path}: {what}; check the camera's card and cable, then resume")
