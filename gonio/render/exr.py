"""OpenEXR files: linear pictures as renderers and compositors read them."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np

from gonio.files import write_bytes

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

_MAGIC, _VERSION = 20000630, 2
_FLOAT = 2


def write_exr(path: Path, picture: NDArray[np.float64]) -> None:
    """Write linear RGB, or RGBA with colors multiplied by alpha, uncompressed in single precision.

    The layout is that of the OpenEXR file format, version 2: single part, scan lines.

    Parameters
    ----------
    path
        Where to; whole or not at all.
    picture
        Shape (height, width, 3 or 4), the first row on top.

    Raises
    ------
    gonio.errors.StorageError
        When it cannot be written.
    """
    height, width, channels = picture.shape
    # channels go in the order of the alphabet
    names, order = ("ABGR", [3, 2, 1, 0]) if channels == 4 else ("BGR", [2, 1, 0])
    header = struct.pack("<ii", _MAGIC, _VERSION) + _attributes(names, width, height)
    planes = np.ascontiguousarray(picture[:, :, order].swapaxes(1, 2), "<f4")
    first = len(header) + 8 * height
    length = 8 + planes[0].nbytes
    offsets = first + length * np.arange(height, dtype="<u8")
    lines = (struct.pack("<ii", y, planes[0].nbytes) + planes[y].tobytes() for y in range(height))
    write_bytes(path, header + offsets.tobytes() + b"".join(lines))


def _attributes(names: str, width: int, height: int) -> bytes:
    channels = b"".join(
        name.encode() + b"\0" + struct.pack("<iiii", _FLOAT, 0, 1, 1) for name in names
    )
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    entries = [
        ("channels", "chlist", channels + b"\0"),
        ("compression", "compression", b"\0"),
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1.0)),
        ("screenWindowCenter", "v2f", struct.pack("<ff", 0.0, 0.0)),
        ("screenWindowWidth", "float", struct.pack("<f", 1.0)),
    ]
    packed = (
        f"{name}\0{kind}\0".encode() + struct.pack("<i", len(value)) + value
        for name, kind, value in entries
    )
    return b"".join(packed) + b"\0"
