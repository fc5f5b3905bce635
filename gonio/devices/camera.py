"""A tethered camera whose files appear in a folder."""

from __future__ import annotations

import hashlib
import logging
import struct
from typing import TYPE_CHECKING

from gonio.devices.frame_check import FrameCheck
from gonio.devices.latent import LatentFrame
from gonio.devices.waiting import wait_until
from gonio.errors import FrameLostError

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.clock import Clock
    from gonio.devices.lamps import LampHead
    from gonio.rig import Rig
    from gonio.transports import FrameFolder

_POLL_S = 0.02
_RAW_IMAGE_DIGEST = 50972


class FolderCamera:
    """A `gonio.devices.Camera` whose shutter the lamp head triggers, and whose files appear.

    Parameters
    ----------
    folder
        Where frames appear.
    lamps
        Whose head opens the shutter.
    rig
        Says how long a file may take.
    clock
        To wait on.
    """

    sends = True

    def __init__(self, folder: FrameFolder, lamps: LampHead, rig: Rig, clock: Clock) -> None:
        self._folder = folder
        self._lamps = lamps
        self._timeout_s = rig.camera.file_timeout_s
        self._clock = clock
        self._check = FrameCheck()

    def prepare(self) -> int:
        """Move what lies in the folder aside; return how many files it was."""
        return self._folder.set_aside()

    def expose(self, exposure_s: float) -> LatentFrame:
        """Open the shutter (see `gonio.devices.Camera`); no file of before counts."""
        before, began_s = self._folder.names(), self._clock.now()
        frame, flux = self._lamps.expose(exposure_s)
        name = f"frame_{frame:06d}.dng"
        if name in before:
            raise FrameLostError(
                f"{name}: lay in the camera's folder before its exposure; the head has restarted "
                "its count: move the file away, then resume"
            )
        return LatentFrame(frame, name, exposure_s, began_s, flux)

    def has(self, frame: LatentFrame) -> bool:
        """Return whether its file is there (see `gonio.devices.Camera`)."""
        return frame.name in self._folder.names()

    def fetch(self, frame: LatentFrame, target: Path) -> None:
        """Wait for a frame's file and move it to `target` (see `gonio.devices.Camera`)."""
        there = wait_until(self._clock, lambda: self.has(frame), self._timeout_s, _POLL_S)
        if not there:
            raise FrameLostError(
                f"{frame.name}: did not come within {self._timeout_s:g} s after its exposure; "
                "check the camera, its tethering and folder in the rig file, then resume"
            )
        self._folder.take(frame.name, target)
        check_whole(target)
        self._check.admit(frame, target)


def check_whole(path: Path) -> None:
    """Refuse a raw file that is shorter than its strips say, or whose pixels are not its own.

    Not every camera writes a digest of the pixels (RawImageDigest, DNG 1.4); without one, a bit
    that flipped on the way is not seen here.

    Raises
    ------
    gonio.errors.FrameLostError
        When it is broken.
    """
    try:
        _check_pixels(path)
    except FrameLostError:
        raise
    except (OSError, ValueError, ArithmeticError, LookupError, TypeError, struct.error) as error:
        raise _broken(path, f"is not a raw file ({error})") from None


def _check_pixels(path: Path) -> None:
    import tifffile

    # it says in a log of its own what the error says as well
    logging.getLogger("tifffile").disabled = True
    with tifffile.TiffFile(path) as tiff:
        page = tiff.pages.first
        strips = list(zip(page.dataoffsets, page.databytecounts, strict=True))
        digest = page.tags.valueof(_RAW_IMAGE_DIGEST)
    size = path.stat().st_size
    if not strips or any(offset + length > size for offset, length in strips):
        need = max((offset + length for offset, length in strips), default=0)
        raise _broken(path, f"has {size} bytes of {need}")
    if digest is not None and bytes(digest) != _digest(path, strips):
        raise _broken(path, "has other pixels than the camera wrote (RawImageDigest)")


def _digest(path: Path, strips: list[tuple[int, int]]) -> bytes:
    """Return the MD5 of the pixels; 16 bits each, little-endian, row by row, as the strips are."""
    data = path.read_bytes()
    pixels = b"".join(data[offset : offset + length] for offset, length in strips)
    return hashlib.md5(pixels, usedforsecurity=False).digest()


def _broken(path: Path, what: str) -> FrameLostError:
    return FrameLostError(f"{path}: {what}; check the camera's card and cable, then resume")
