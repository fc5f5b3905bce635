"""The 24-patch color chart: its layout, and what its patches are known to be."""

from __future__ import annotations

import csv
from functools import lru_cache
from importlib import resources
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.color import D50, D65, adaptation, xyz_from_lab

if TYPE_CHECKING:
    from numpy.typing import NDArray

ROWS: Final = 4
COLUMNS: Final = 6
PATCHES: Final = ROWS * COLUMNS
GREYS: Final = slice(18, 24)
"""From white to black, the last row."""

CORNERS: Final = (0, 5, 23, 18)
"""Dark skin, bluish green, black, white: round the chart as one reads it."""


def places() -> NDArray[np.float64]:
    """Return the patches' centres by column and row, in patches, shape (24, 2)."""
    rows, columns = np.divmod(np.arange(PATCHES), COLUMNS)
    return np.stack([columns, rows], axis=-1).astype(np.float64)


@lru_cache(maxsize=1)
def _published() -> tuple[tuple[str, ...], tuple[tuple[float, ...], ...]]:
    text = (resources.files("gonio") / "data" / "colorchecker24.csv").read_text(encoding="utf-8")
    rows = list(csv.reader(text.splitlines()))[1:]
    return tuple(row[0] for row in rows), tuple(tuple(map(float, row[1:])) for row in rows)


def patch_names() -> tuple[str, ...]:
    """Return the patches' names, row by row from dark skin to black."""
    return _published()[0]


def published_xyz() -> NDArray[np.float64]:
    """Return XYZ of the patches adapted to D65, a perfect diffuser's Y being 1, shape (24, 3).

    From CIELAB under D50 (2 degree observer) that X-Rite publishes for charts made since November
    2014, by Bradford's adaptation.
    """
    return xyz_from_lab(_published()[1], D50) @ adaptation(D50, D65).T
