"""Raw frames as the sensor gave them: the Bayer plane of a DNG, never demosaiced."""

from __future__ import annotations

import io
import logging
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gonio.calibration import CameraIdentity
from gonio.errors import BadFileError
from gonio.files import sha256_bytes
from gonio.reduce.file_matrix import FileMatrix, file_matrix

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

_NOT_OURS: Final = "a DNG as docs/topics/reduction.md describes it is needed"

_CFA = 32803
_EXIF, _PHOTOMETRIC, _AS_SHOT_NEUTRAL = 34665, 262, 50728
_MODEL, _SERIAL = 50708, 50735
SATURATED: Final = 0.98
"""Share of the range from which a pixel counts as saturated: sensors bend before they clip."""


@dataclass(frozen=True)
class Sensor:
    """What all frames of one camera at one setting have in common.

    Attributes
    ----------
    width, height
        In pixels.
    pattern
        Filter colors of the 2 x 2 cell, row by row, such as "RGGB".
    black, white
        BlackLevel (the highest of the cell) and WhiteLevel, in raw units.
    iso
        Sensitivity; None where the file does not say.
    color_matrix
        XYZ under D65 to camera RGB, nine numbers row by row; none where the file has none.
    matrix_name
        Which of the file's matrices that is.
    model
        UniqueCameraModel and, where the file states one, CameraSerialNumber.
    scaled
        Whether the matrix tells how bright its channels are against each other: the file has an
        AsShotNeutral, which is in the same scale (DNG 1.7, chapter 6).
    """

    width: int
    height: int
    pattern: str
    black: int
    white: int
    iso: int | None
    color_matrix: tuple[float, ...]
    matrix_name: str = "ColorMatrix1"
    model: str = ""
    scaled: bool = False

    @property
    def saturation(self) -> float:
        """The raw value from which a pixel counts as saturated: 98 % of the range."""
        return self.black + SATURATED * (self.white - self.black)

    @property
    def identity(self) -> CameraIdentity:
        """Which camera it is, at which setting."""
        return CameraIdentity.model_validate(
            {name: getattr(self, name) for name in CameraIdentity.model_fields}
        )

    def channel(self, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return 0, 1 or 2 for pixels behind a red, green or blue filter."""
        cell = np.array(["RGB".index(color) for color in self.pattern])
        channel: NDArray[np.intp] = cell[2 * (rows % 2) + columns % 2]
        return channel


@dataclass(frozen=True)
class RawFrame:
    """One exposure.

    Attributes
    ----------
    mosaic
        Raw values, black level included, shape (height, width).
    exposure_s
        How long the shutter truly was open, by the file.
    sensor
        What took it.
    """

    mosaic: NDArray[np.uint16]
    exposure_s: float
    sensor: Sensor


def read_vouched(path: Path, sha256: str, remedy: str) -> bytes:
    """Read a file whose content must hash to `sha256`, in hexadecimal.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing or has changed; LibRaw would read a damaged plane in silence.
    """
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise BadFileError(path, "no such file", remedy) from None
    except OSError as error:
        raise BadFileError(path, f"cannot be read ({error.strerror})", remedy) from None
    if sha256_bytes(data) != sha256:
        raise BadFileError(path, "has changed since the journal vouched for it", remedy)
    return data


def decode_raw(data: bytes, path: Path, remedy: str) -> RawFrame:
    """Decode a DNG file with one Bayer plane, which came from `path`.

    Raises
    ------
    gonio.errors.BadFileError
        When it is cut short, or no such DNG.
    """
    tags = _tags(data, path, remedy)
    mosaic, pattern, black, white = _decode(data, path, remedy)
    matrix = file_matrix(tags, path) or FileMatrix((), "none")
    sensor = Sensor(
        width=mosaic.shape[1],
        height=mosaic.shape[0],
        pattern=pattern,
        black=black,
        white=white,
        iso=_iso(tags),
        color_matrix=matrix.values,
        matrix_name=matrix.name,
        model=" ".join(str(tags[tag]) for tag in (_MODEL, _SERIAL) if tag in tags),
        scaled=_AS_SHOT_NEUTRAL in tags,
    )
    return RawFrame(mosaic, _exposure_s(tags, path), sensor)


def _tags(data: bytes, path: Path, remedy: str) -> dict[int, Any]:
    """Return the tags of the first directory: LibRaw keeps neither ExposureTime nor the matrix."""
    import tifffile

    # it would print its own opinion of a broken file beside our one line
    logging.getLogger("tifffile").disabled = True
    try:
        with tifffile.TiffFile(io.BytesIO(data)) as tiff:
            page = tiff.pages.first
            tags = {tag.code: tag.value for tag in page.tags.values()}
            strips = list(zip(page.dataoffsets, page.databytecounts, strict=False))
            end = max(map(sum, strips), default=0)
    except (
        ValueError, TypeError, LookupError, AttributeError, ArithmeticError, OSError, struct.error,
    ) as error:  # fmt: skip
        raise BadFileError(path, f"is not a DNG ({error})", _NOT_OURS) from None
    if tags.get(_PHOTOMETRIC) != _CFA:
        raise BadFileError(path, "holds no Bayer plane", _NOT_OURS)
    if not strips:
        raise BadFileError(path, "does not say where its pixels are", _NOT_OURS)
    if end > len(data):
        raise BadFileError(path, f"is cut short, by {end - len(data)} bytes", remedy)
    return tags


def _decode(data: bytes, path: Path, remedy: str) -> tuple[NDArray[np.uint16], str, int, int]:
    import rawpy

    try:
        with rawpy.imread(io.BytesIO(data)) as raw:
            # the array is LibRaw's own memory, gone with the file
            mosaic = np.array(raw.raw_image, np.uint16)
            cell = np.ravel(() if raw.raw_pattern is None else raw.raw_pattern)
            pattern = "".join(chr(raw.color_desc[i]) for i in cell)
            black, white = max(raw.black_level_per_channel), int(raw.white_level)
    except rawpy.LibRawError as error:
        raise BadFileError(path, f"cannot be decoded ({_reason(error)})", remedy) from None
    except (LookupError, NotImplementedError, TypeError, ValueError):
        # a pattern of colors that the file does not have, or no plane at all
        raise BadFileError(path, "holds no Bayer plane", _NOT_OURS) from None
    if mosaic.ndim != 2 or sorted(pattern) != ["B", "G", "G", "R"] or white <= black:
        raise BadFileError(path, "is not a red, green and blue Bayer plane", _NOT_OURS)
    return mosaic, pattern, int(black), white


def _reason(error: Exception) -> str:
    first = error.args[0] if error.args else type(error).__name__
    return first.decode("ascii", "replace") if isinstance(first, bytes) else str(first)


def _exposure_s(tags: dict[int, Any], path: Path) -> float:
    exif = tags.get(_EXIF)
    ratio = exif.get("ExposureTime") if isinstance(exif, dict) else None
    if not (isinstance(ratio, tuple) and len(ratio) == 2 and min(ratio) > 0):
        raise BadFileError(path, "states no ExposureTime", _NOT_OURS)
    return float(ratio[0]) / float(ratio[1])


def _iso(tags: dict[int, Any]) -> int | None:
    exif = tags.get(_EXIF)
    iso = exif.get("ISOSpeedRatings") if isinstance(exif, dict) else None
    return iso if isinstance(iso, int) else None
