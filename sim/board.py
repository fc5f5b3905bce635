"""The ChArUco board of the sample holder, uncut: a target whose every corner is known."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.board import BOARD_SIDE_MM, charuco_board
from nnbrdf.analytic import Lambert

if TYPE_CHECKING:
    from numpy.typing import NDArray

_PAPER, _INK = 0.85, 0.05
# all edges of squares, markers and their cells lie on this grid
_CELLS_PER_MM: Final = 2
# a pixel sees the mean of so many points, on a lattice of which no two share a row, a column or a
# diagonal: an edge along any of these moves by 1/17 px before it is seen to
_POINTS, _STEP = 17, 5


class CharucoBoard:
    """Matte ink on matte paper, 13 x 13 squares of 10 mm, markers of DICT_5X5_100 of 7 mm.

    OpenCV's board coordinates are (x + 65, 65 - y) mm; the square at -x and +y is black.
    """

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the board's mean as a material (see `gonio.protocols.Material`)."""
        mean = _INK + (_PAPER - _INK) * float(_cells().mean())
        return Lambert((mean, mean, mean)).evaluate(light, view)


def printed_at(points_mm: NDArray[np.float64], where: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return the BRDF of what is printed as pixels see it, the mean over what lies in each.

    Parameters
    ----------
    points_mm
        Where the middle of each pixel looks, shape (height, width, 3).
    where
        Which pixels, n of them, shape (height, width).

    Returns
    -------
    ndarray
        In 1/sr, shape (n,), 0 beyond the board.
    """
    places = points_mm[..., :2]
    down, across = (np.asarray(np.gradient(places, axis=axis))[where] for axis in (0, 1))
    total = np.zeros(len(down))
    for point in range(_POINTS):
        row = (point + 0.5) / _POINTS - 0.5
        column = (_STEP * point % _POINTS + 0.5) / _POINTS - 0.5
        total += _reflectance(places[where] + row * down + column * across)
    return total / (_POINTS * np.pi)


def _reflectance(places_mm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the reflectance at places on the plane, shape (..., 2) to (...)."""
    half = BOARD_SIDE_MM / 2.0
    column = np.floor((places_mm[..., 0] + half) * _CELLS_PER_MM).astype(int)
    row = np.floor((half - places_mm[..., 1]) * _CELLS_PER_MM).astype(int)
    cells = _cells()
    last = len(cells) - 1
    inside = (row >= 0) & (row <= last) & (column >= 0) & (column <= last)
    is_paper = cells[row.clip(0, last), column.clip(0, last)]
    return np.where(inside, np.where(is_paper, _PAPER, _INK), 0.0)


@lru_cache(maxsize=1)
def _cells() -> NDArray[np.bool_]:
    """Return where there is paper, half a millimetre a cell, the first row at +y."""
    side = round(BOARD_SIDE_MM * _CELLS_PER_MM)
    return np.asarray(charuco_board().generateImage((side, side)) > 127, np.bool_)
