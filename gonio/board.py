"""The ChArUco board that frames the sample: where its squares, markers and corners are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

SQUARES: Final = 13
"""Along each side."""

SQUARE_MM: Final = 10.0
MARKER_MM: Final = 7.0
BOARD_SIDE_MM: Final = SQUARES * SQUARE_MM

MODULE_MM: Final = 1.0
"""Side of the smallest square of a marker: five of its word and a rim of one at each side."""


def charuco_board() -> Any:
    """Return the board for OpenCV, uncut; markers of DICT_5X5_100."""
    import cv2

    words = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_5X5_100)
    return cv2.aruco.CharucoBoard((SQUARES, SQUARES), SQUARE_MM, MARKER_MM, words)


def corner_points_mm(ids: ArrayLike) -> NDArray[np.float64]:
    """Return where corners of squares are in the sample's frame, z = 0.

    Parameters
    ----------
    ids
        OpenCV's numbers, shape (n,): row by row from the corner nearest to -x and +y.

    Returns
    -------
    ndarray
        In mm, shape (n, 3).
    """
    row, column = np.divmod(np.asarray(ids, np.intp), SQUARES - 1)
    half = BOARD_SIDE_MM / 2.0
    x, y = (column + 1) * SQUARE_MM - half, half - (row + 1) * SQUARE_MM
    return np.stack([x, y, np.zeros(len(x))], axis=-1)
