"""A file of the array, written picture by picture as it is stored: Zarr's shards, uncompressed.

Zarr would hold the whole file in memory, and takes longer to sort it into squares than all the rest
of the reduction does (https://zarr-specs.readthedocs.io, codecs `sharding_indexed` and `crc32c`).
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gonio.files import sync_file

if TYPE_CHECKING:
    from pathlib import Path
    from types import TracebackType
    from typing import Self

    from numpy.typing import NDArray

_NOWHERE: Final = np.uint64(2**64 - 1)


class Shard:
    """A file that comes to be; it is whole under its name, or not there.

    Parameters
    ----------
    path
        Where it will be.
    views, across
        How many pictures it has room for, and squares along each side of one.
    """

    def __init__(self, path: Path, views: int, across: int) -> None:
        # a worker whose scheduler was killed may still write the same
        self._path, self._aside = path, path.with_name(f".{path.name}.{os.getpid()}")
        self._index = np.full((views, across * across, 2), _NOWHERE, "<u8")
        self._crc, self.bytes = 0, 0

    def __enter__(self) -> Self:
        self._path.parent.mkdir(parents=True, exist_ok=True)
        self._file = self._aside.open("wb")
        return self

    def put(self, view: int, tiles: NDArray[Any]) -> None:
        """Add a picture, shape (across, across, tile, tile, 3)."""
        import google_crc32c

        squares = tiles.reshape(self._index.shape[1], -1).view(np.uint8)
        # each square with its sum, so that whoever reads it finds a flipped bit
        sums = np.array([google_crc32c.value(square) for square in squares], "<u4")
        summed = np.hstack([squares, sums[:, None].view(np.uint8)])
        size = summed.shape[1]
        self._index[view, :, 0] = self.bytes + size * np.arange(len(squares))
        self._index[view, :, 1] = size
        self._write(summed.reshape(-1))

    def _write(self, data: NDArray[np.uint8]) -> None:
        import google_crc32c

        self._crc = google_crc32c.extend(self._crc, data)
        self.bytes += data.size
        self._file.write(data.data)

    def __exit__(
        self, kind: type[BaseException] | None, error: object, trace: TracebackType | None
    ) -> None:
        import google_crc32c

        try:
            if kind is None and self.bytes:
                index = self._index.tobytes()
                index += google_crc32c.value(index).to_bytes(4, "little")
                self._write(np.frombuffer(index, np.uint8))
                self._file.close()
                sync_file(self._aside)
                self._aside.replace(self._path)
        finally:
            self._file.close()
            self._aside.unlink(missing_ok=True)

    @property
    def mark(self) -> tuple[int, int]:
        """Size and CRC-32C of the file."""
        return self.bytes, self._crc


def mark_of(path: Path) -> tuple[int, int]:
    """Return size and CRC-32C of a file; of one that is missing, zeros."""
    import google_crc32c

    size = crc = 0
    if path.is_file():
        with path.open("rb") as file:
            while block := file.read(1 << 24):
                crc, size = google_crc32c.extend(crc, block), size + len(block)
    return size, crc
