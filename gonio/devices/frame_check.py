"""Whether a file is of the exposure that it is taken for: by unique id, checksum, shutter, date."""

from __future__ import annotations

import struct
from datetime import datetime
from typing import TYPE_CHECKING, Any, NamedTuple

from gonio.devices.shutter_speeds import is_exposure
from gonio.errors import FrameLostError
from gonio.files import sha256_file

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.devices.latent import LatentFrame

_EXIF, _DATE_TIME = 34665, 306
_DATE_FORM = "%Y:%m:%d %H:%M:%S"
# dates have whole seconds, and a camera may write either end of the exposure
_DATE_SLACK_S = 2.0


class _Taken(NamedTuple):
    """A file's date by the camera's clock, and when it was triggered by the driver's."""

    date: datetime
    triggered_s: float
    exposure_s: float


class FrameCheck:
    """Tells the file of an exposure from those of others, as far as files say who they are.

    A camera's clock need not be right: what counts is how long, by it, two files are apart.
    """

    def __init__(self) -> None:
        self._seen: dict[str, str] = {}
        self._last: _Taken | None = None

    def admit(self, frame: LatentFrame, path: Path) -> None:
        """Refuse the file at `path` where it is not that of `frame`.

        Raises
        ------
        gonio.errors.FrameLostError
            When it was taken before, was exposed for another time, or is older than its exposure.
        """
        tags = _tags(path)
        self._check_new(frame, path, tags)
        self._check_date(frame, tags)
        open_s = _ratio(tags.get("ExposureTime"))
        if open_s and not is_exposure(open_s, frame.exposure_s):
            raise _not_its_own(
                frame, f"was open {open_s:g} s, not the {frame.exposure_s:g} s asked for"
            )

    def _check_new(self, frame: LatentFrame, path: Path, tags: dict[str, Any]) -> None:
        unique = str(tags.get("ImageUniqueID") or "").strip("\0 ")
        for identity in filter(None, (unique, sha256_file(path))):
            before = self._seen.setdefault(identity, f"{frame.number} ({frame.name})")
            if before != f"{frame.number} ({frame.name})":
                what = "ImageUniqueID" if identity == unique else "content"
                raise _not_its_own(frame, f"has the {what} of frame {before}")

    def _check_date(self, frame: LatentFrame, tags: dict[str, Any]) -> None:
        date = _date(tags.get("DateTimeOriginal") or tags.get("DateTime"))
        if date is None:
            return
        before, self._last = self._last, _Taken(date, frame.triggered_s, frame.exposure_s)
        if before is None:
            return
        apart_s = (date - before.date).total_seconds()
        at_least_s = frame.triggered_s - before.triggered_s - before.exposure_s - _DATE_SLACK_S
        if apart_s < at_least_s:
            raise _not_its_own(
                frame, f"is {at_least_s - apart_s:.0f} s older than its exposure, by its date"
            )


def _not_its_own(frame: LatentFrame, what: str) -> FrameLostError:
    return FrameLostError(
        f"camera: {frame.name}: {what}: it is the file of another exposure; let nothing else "
        "trigger the camera, then resume"
    )


def _tags(path: Path) -> dict[str, Any]:
    """Return what a file says of its exposure; whatever does not say it, says nothing."""
    import tifffile

    try:
        with tifffile.TiffFile(path) as tiff:
            tags = tiff.pages.first.tags
            exif = tags.valueof(_EXIF)
            return {"DateTime": tags.valueof(_DATE_TIME)} | (exif if isinstance(exif, dict) else {})
    except (OSError, ValueError, ArithmeticError, LookupError, TypeError, struct.error):
        return {}


def _ratio(value: Any) -> float:
    is_ratio = isinstance(value, tuple) and len(value) == 2 and value[1]
    return float(value[0]) / float(value[1]) if is_ratio else 0.0


def _date(text: Any) -> datetime | None:
    try:
        return datetime.strptime(str(text)[:19], _DATE_FORM)
    except ValueError:
        return None
