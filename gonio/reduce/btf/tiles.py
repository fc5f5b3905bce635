"""A finished array, read a square of texels at a time with all pairs that were measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadFileError, BadInputError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from gonio.reduce.btf.store import Btf


@dataclass(frozen=True)
class Tile:
    """A square of texels.

    Attributes
    ----------
    rows, columns
        Where it is in the array.
    """

    rows: slice
    columns: slice


@dataclass(frozen=True)
class Texels:
    """The measured pairs of an array, and the texels of its middle.

    Attributes
    ----------
    btf
        The array.
    side
        How many texels along each side of the middle.

    Raises
    ------
    gonio.errors.BadInputError
        When there are fewer.
    """

    btf: Btf
    side: int

    def __post_init__(self) -> None:
        whole = self.btf.side
        if not 1 <= self.side <= whole:
            raise BadInputError(f"a side of {self.side} texels is not there; use 1 to {whole}")

    def pairs(self) -> NDArray[np.intp]:
        """Return light and view of each pair that was measured, shape (pairs, 2)."""
        return np.argwhere(np.isfinite(self.btf.group["light_mm"][...]).all(axis=-1))

    def tiles(self) -> Iterator[Tile]:
        """Yield the middle in squares that the file stores as such, cut where the middle ends."""
        spans = list(self._spans())
        for rows in spans:
            for columns in spans:
                yield Tile(rows, columns)

    def _spans(self) -> Iterator[slice]:
        first = (self.btf.side - self.side) // 2
        step, end = self.btf.group["value"].chunks[2], first + self.side
        for start in range(first // step * step, end, step):
            yield slice(max(start, first), min(start + step, end))

    def within(self, tile: Tile) -> tuple[slice, slice]:
        """Return where a tile is in the middle."""
        first = (self.btf.side - self.side) // 2
        rows, columns = tile.rows, tile.columns
        return (
            slice(rows.start - first, rows.stop - first),
            slice(columns.start - first, columns.stop - first),
        )

    def points_mm(self, tile: Tile) -> NDArray[np.float64]:
        """Return the middles of a tile's texels, row by row, shape (n, 3)."""
        x = self.btf.group["x"][tile.columns]
        y = self.btf.group["y"][tile.rows]
        columns, rows = np.meshgrid(x, y)
        return np.stack([columns, rows, np.zeros_like(rows)], axis=-1).reshape(-1, 3)

    def values(self, tile: Tile, pairs: NDArray[np.intp]) -> NDArray[np.float32]:
        """Return the BRDF of a tile's texels at pairs in order of the light, (pairs, n, 3).

        Raises
        ------
        gonio.errors.BadFileError
            When a file of the array is not as it was written.
        """
        array, parts = self.btf.group["value"], []
        # light by light: of pairs chosen freely, few of all combinations are there
        for light in np.unique(pairs[:, 0]).tolist():
            views = pairs[pairs[:, 0] == light, 1]
            lowest = int(views.min())
            span = slice(lowest, int(views.max()) + 1)
            try:
                parts.append(array[light, span, tile.rows, tile.columns][views - lowest])
            except ValueError as error:  # a sum that does not fit
                raise BadFileError(
                    self.btf.path / "value",
                    f"has changed since it was written, at light {light} ({error})",
                    "make it again with: gonio reduce --btf --anew",
                ) from None
        found: NDArray[np.float32] = np.concatenate(parts)
        return found.reshape(len(pairs), -1, 3)
