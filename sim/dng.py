"""A DNG writer for one uncompressed 16-bit Bayer plane (Adobe DNG 1.4, TIFF 6.0, Exif 2.3)."""

from __future__ import annotations

import hashlib
import struct
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import ArrayLike, NDArray

D65: Final = 21
"""CalibrationIlluminant1 of daylight at 6500 K (Exif's LightSource)."""

_HEADER = struct.Struct("<2sHI")
_ENTRY = struct.Struct("<HHI4s")
_FINEST = 10**7
_CFA_COLORS = "RGB"


def dng_bytes(
    mosaic: NDArray[np.uint16],
    *,
    cfa: str = "RGGB",
    black: int,
    white: int,
    exposure_s: float,
    iso: int,
    color_matrix: ArrayLike,
    as_shot_neutral: ArrayLike,
    camera_model: str,
    unique_id: str,
) -> bytes:
    """Return a whole DNG file.

    Parameters
    ----------
    mosaic
        Raw values, shape (height, width).
    cfa
        Filter colors of the 2 x 2 cell, row by row.
    black, white
        BlackLevel and WhiteLevel, in raw units.
    exposure_s
        The shutter's true time.
    iso
        Sensitivity, for the record: values are raw.
    color_matrix
        ColorMatrix1, shape (3, 3): XYZ under D65 to camera RGB.
    as_shot_neutral
        Camera RGB of a neutral patch, shape (3,), the largest 1.
    camera_model
        UniqueCameraModel, ASCII.
    unique_id
        ImageUniqueID, 32 hexadecimal digits.
    """
    strip = np.ascontiguousarray(mosaic, "<u2").tobytes()
    image = [
        *_plane_fields(mosaic),
        *_filter_fields(cfa, black, white),
        *_color_fields(color_matrix, as_shot_neutral, camera_model),
        # RawImageDigest: MD5 of the pixels row by row, 16 bits each, the low byte first
        _bytes(50972, hashlib.md5(strip, usedforsecurity=False).digest()),
    ]
    exif = [
        _rationals(33434, [exposure_s]),
        _shorts(34855, [iso]),
        _Field(36864, 7, 4, b"0230"),
        _ascii(42016, unique_id),
    ]
    # the strip comes last, so that a file cut short is short of pixels and of nothing else
    exif_at = _HEADER.size + len(_directory(_placed(image, 0, 0), 0))
    strip_at = exif_at + len(_directory(exif, 0))
    return b"".join(
        [
            _HEADER.pack(b"II", 42, _HEADER.size),
            _directory(_placed(image, exif_at, strip_at), _HEADER.size),
            _directory(exif, exif_at),
            strip,
        ]
    )


def _plane_fields(mosaic: NDArray[np.uint16]) -> list[_Field]:
    height, width = mosaic.shape
    return [
        _longs(254, [0]),
        _longs(256, [width]),
        _longs(257, [height]),
        _shorts(258, [16]),
        _shorts(259, [1]),
        _shorts(262, [32803]),
        _shorts(274, [1]),
        _shorts(277, [1]),
        _longs(278, [height]),
        _longs(279, [mosaic.nbytes]),
        _shorts(284, [1]),
    ]


def _filter_fields(cfa: str, black: int, white: int) -> list[_Field]:
    return [
        _shorts(33421, [2, 2]),
        _bytes(33422, [_CFA_COLORS.index(color) for color in cfa]),
        _bytes(50710, [0, 1, 2]),
        _shorts(50711, [1]),
        _shorts(50713, [1, 1]),
        _longs(50714, [black]),
        _longs(50717, [white]),
    ]


def _color_fields(matrix: ArrayLike, neutral: ArrayLike, model: str) -> list[_Field]:
    return [
        _bytes(50706, [1, 4, 0, 0]),
        _bytes(50707, [1, 1, 0, 0]),
        _ascii(50708, model),
        _signed_rationals(50721, np.ravel(matrix)),
        _rationals(50728, np.ravel(neutral)),
        _shorts(50778, [D65]),
    ]


def _placed(image: list[_Field], exif_at: int, strip_at: int) -> list[_Field]:
    """Add where the other parts of the file lie; TIFF wants tags in rising order."""
    pointers = [_longs(273, [strip_at]), _longs(34665, [exif_at])]
    return sorted(image + pointers, key=lambda field: field.tag)


@dataclass(frozen=True)
class _Field:
    """A TIFF field: its tag, its type's number, how many values, and their bytes."""

    tag: int
    type: int
    count: int
    data: bytes


def _directory(fields: Sequence[_Field], at: int) -> bytes:
    """Lay out an image file directory that starts at byte `at`, longer values behind it."""
    values_at = at + 2 + _ENTRY.size * len(fields) + 4
    entries, values = [], b""
    for field in fields:
        inline = field.data.ljust(4, b"\0")
        if len(field.data) > 4:
            inline = struct.pack("<I", values_at + len(values))
            # TIFF wants values at even offsets
            values += field.data + b"\0" * (len(field.data) % 2)
        entries.append(_ENTRY.pack(field.tag, field.type, field.count, inline))
    return struct.pack("<H", len(fields)) + b"".join(entries) + struct.pack("<I", 0) + values


def _bytes(tag: int, values: Sequence[int]) -> _Field:
    return _Field(tag, 1, len(values), bytes(values))


def _ascii(tag: int, text: str) -> _Field:
    data = text.encode("ascii") + b"\0"
    return _Field(tag, 2, len(data), data)


def _shorts(tag: int, values: Sequence[int]) -> _Field:
    return _Field(tag, 3, len(values), struct.pack(f"<{len(values)}H", *values))


def _longs(tag: int, values: Sequence[int]) -> _Field:
    return _Field(tag, 4, len(values), struct.pack(f"<{len(values)}I", *values))


def _rationals(tag: int, values: Iterable[float]) -> _Field:
    parts = _ratios(values)
    return _Field(tag, 5, len(parts) // 2, struct.pack(f"<{len(parts)}I", *parts))


def _signed_rationals(tag: int, values: Iterable[float]) -> _Field:
    parts = _ratios(values)
    return _Field(tag, 10, len(parts) // 2, struct.pack(f"<{len(parts)}i", *parts))


def _ratios(values: Iterable[float]) -> list[int]:
    """Return numerators and denominators in turn, each value to about 14 digits."""
    return [part for value in values for part in _ratio(float(value))]


# a matrix is the same in all frames
@lru_cache(maxsize=32)
def _ratio(value: float) -> tuple[int, int]:
    return Fraction(value).limit_denominator(_FINEST).as_integer_ratio()
