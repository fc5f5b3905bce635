"""The container of RGL's tensor files: named arrays (Dupuy and Jakob 2018).

After `tensor_file`, a null, two bytes of version and the number of fields, each field is its name,
its number of dimensions, its type, the offset of its data and its shape; all little-endian.
"""

from __future__ import annotations

import struct
from math import prod
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gonio.errors import BadFileError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

MAGIC: Final = b"tensor_file\0"
_VERSION: Final = b"\x01\x00"
_TYPES: Final = (
    None, "u1", "i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f2", "<f4", "<f8",
)  # fmt: skip
_MOST_FIELDS: Final = 64
_MOST_DIMENSIONS: Final = 8
_ALIGNED: Final = 8
_REMEDY = "expected: an RGL tensor file (.bsdf) of version 1.0"


def unpack(content: bytes, path: Path) -> dict[str, NDArray[Any]]:
    """Return the arrays by name, as views of the content.

    Raises
    ------
    gonio.errors.BadFileError
        When the file ends before what its header tells, or is of another kind.
    """
    if not content.startswith(MAGIC + _VERSION):
        raise BadFileError(path, "does not begin as a tensor file does", _REMEDY)
    start = len(MAGIC) + len(_VERSION)
    try:
        (count,) = struct.unpack_from("<I", content, start)
        if count > _MOST_FIELDS:
            raise BadFileError(path, f"tells of {count} fields", _REMEDY)
        return dict(_fields(content, start + 4, count))
    except (struct.error, ValueError) as error:
        raise BadFileError(path, f"has a broken header ({error})", _REMEDY) from None


def pack(fields: Mapping[str, NDArray[Any]]) -> bytes:
    """Return a tensor file of arrays by name."""
    start = len(MAGIC) + len(_VERSION) + 4
    start += sum(13 + len(name) + 8 * array.ndim for name, array in fields.items())
    header, data = [MAGIC, _VERSION, struct.pack("<I", len(fields))], []
    end = start
    for name, array in fields.items():
        gap = -end % _ALIGNED
        content = np.ascontiguousarray(array).tobytes()
        kind = _TYPES.index(array.dtype.str.replace("|", ""))
        header.append(struct.pack("<H", len(name)) + name.encode())
        header.append(struct.pack("<HBQ", array.ndim, kind, end + gap))
        header.append(struct.pack(f"<{array.ndim}Q", *array.shape))
        data.append(b"\0" * gap + content)
        end += gap + len(content)
    return b"".join(header + data)


def _fields(content: bytes, at: int, count: int) -> list[tuple[str, NDArray[Any]]]:
    fields = []
    for _ in range(count):
        (length,) = struct.unpack_from("<H", content, at)
        name = content[at + 2 : at + 2 + length].decode("ascii")
        at += 2 + length
        dimensions, kind, offset = struct.unpack_from("<HBQ", content, at)
        if dimensions > _MOST_DIMENSIONS:
            raise ValueError(f"{name[:20]!r} has {dimensions} dimensions")
        if not 0 < kind < len(_TYPES):
            raise ValueError(f"{name[:20]!r} is of unknown type {kind}")
        shape = struct.unpack_from(f"<{dimensions}Q", content, at + 11)
        at += 11 + 8 * dimensions
        fields.append((name, _array(content, name, np.dtype(_TYPES[kind]), offset, shape)))
    return fields


def _array(
    content: bytes, name: str, dtype: np.dtype[Any], offset: int, shape: tuple[int, ...]
) -> NDArray[Any]:
    # Python's numbers have no end, so no product of them comes round
    if offset + prod(shape) * dtype.itemsize > len(content):
        raise ValueError(f"{name[:20]!r} ends beyond the file")
    return np.frombuffer(content, dtype, prod(shape), offset).reshape(shape)
