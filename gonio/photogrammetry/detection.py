"""The board's corners in a picture, by OpenCV's ArUco module."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.board import MODULE_MM, charuco_board, corner_points_mm

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import CameraSpec

LEAST_PX_PER_MODULE: Final = 3.0
"""Below it words of markers are misread or missed."""


@dataclass(frozen=True)
class BoardView:
    """The corners that one picture shows.

    Attributes
    ----------
    theta, phi
        The view arm's angles by its encoders, in radians.
    ids
        Of the corners, as OpenCV numbers them, shape (n,).
    pixels
        Where they are, column and row, shape (n, 2).
    """

    theta: float
    phi: float
    ids: NDArray[np.intp]
    pixels: NDArray[np.float64]

    @property
    def points_mm(self) -> NDArray[np.float64]:
        """Where they are in the sample's frame, shape (n, 3)."""
        return corner_points_mm(self.ids)


def px_per_module(spec: CameraSpec, theta: float) -> float:
    """Return the shorter side in pixels of a marker's module, seen from a polar angle in rad."""
    return MODULE_MM * spec.focal_px / (1000.0 * spec.distance_m) * math.cos(theta)


def find_corners(picture: NDArray[np.uint8], theta: float, phi: float) -> BoardView:
    """Find the corners of the board's squares, none in a picture without it.

    Parameters
    ----------
    picture
        Grey, shape (height, width).
    theta, phi
        The view arm's angles by its encoders, in radians.
    """
    import cv2

    pixels, ids, _, _ = cv2.aruco.CharucoDetector(charuco_board()).detectBoard(picture)
    if ids is None or len(ids) == 0:
        return BoardView(theta, phi, np.zeros(0, np.intp), np.zeros((0, 2)))
    return BoardView(
        theta, phi, np.ravel(ids).astype(np.intp), np.asarray(pixels, np.float64).reshape(-1, 2)
    )
