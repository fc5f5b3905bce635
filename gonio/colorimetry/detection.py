"""Where a color chart's patches are in a frame: found by OpenCV, or from stated corners."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gonio.chart import CORNERS, PATCHES, places
from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

CORE: Final = 0.6
"""Share of the distance between patches along whose middle a patch is read."""

_LEAST_PX = 640


def find_chart(picture: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Find a 24-patch chart, however it is turned.

    Parameters
    ----------
    picture
        One pixel for each cell of a frame's mosaic, blue first, shape (height, width, 3).

    Returns
    -------
    ndarray
        The homography from columns and rows of patches to columns and rows of the frame's pixels,
        shape (3, 3).

    Raises
    ------
    gonio.errors.BadInputError
        When there is none, or its detector is missing from this OpenCV.
    """
    import cv2

    times = -(-_LEAST_PX // min(picture.shape[:2]))
    large = cv2.resize(picture, None, fx=times, fy=times, interpolation=cv2.INTER_CUBIC)
    found = _detected(np.asarray(large, np.uint8))
    if found is None:
        raise BadInputError(
            "no chart of 24 patches is found in the picture; check light, sharpness and that all "
            "of it is seen, or state where it is with --corners"
        )
    centres = np.asarray(found.getColorCharts()).reshape(PATCHES, 4, 2).mean(axis=1)
    # the middle of a cell's first pixel is at 0, that of the cell at 1/2
    return _homography(places(), 2.0 * ((centres + 0.5) / times - 0.5) + 0.5)


def _detected(picture: NDArray[np.uint8]) -> Any:
    """Return OpenCV's best chart, None where it sees none; majors 4 and 5 differ in names."""
    import cv2

    mcc: Any = getattr(cv2, "mcc", None)
    try:
        make = getattr(mcc, "CCheckerDetector_create", None) or mcc.CCheckerDetector.create
        detector: Any = make()
        if hasattr(detector, "setColorChartType"):
            detector.setColorChartType(mcc.MCC24)
            seen = detector.process(picture, 1)
        else:
            seen = detector.process(picture, mcc.MCC24, 1)
    except AttributeError:
        raise BadInputError(
            f"OpenCV {cv2.__version__} lacks the chart detector; state where the chart is with "
            "--corners, or install opencv-contrib-python-headless"
        ) from None
    return detector.getBestColorChecker() if seen else None


def at_corners(corners_px: Sequence[tuple[float, float]]) -> NDArray[np.float64]:
    """Return the homography of `find_chart` from the corner patches' centres.

    Parameters
    ----------
    corners_px
        Column and row of dark skin, bluish green, black and white, in this order.

    Raises
    ------
    gonio.errors.BadInputError
        When three of them are in a line.
    """
    pixels = np.asarray(corners_px, np.float64)
    turns = [
        np.linalg.det(np.stack([b - a, c - b]))
        for a, b, c in (pixels[[i, (i + 1) % 4, (i + 2) % 4]] for i in range(4))
    ]
    if min(np.abs(turns)) < 1.0 or abs(np.sign(turns).sum()) < 4:
        raise BadInputError(
            "--corners: these are not the corners of a chart; give the middles of the patches dark "
            "skin, bluish green, black and white, in this order round the chart"
        )
    return _homography(places()[list(CORNERS)], pixels)


def _homography(patches: NDArray[np.float64], pixels: NDArray[np.float64]) -> NDArray[np.float64]:
    import cv2

    matrix, _ = cv2.findHomography(patches, pixels)
    return np.asarray(matrix, np.float64)


def patch_outlines(homography: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the corners of where patches are read, in columns and rows, shape (24, 4, 2)."""
    square = 0.5 * CORE * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    return _through(homography, places()[:, None] + square)


def patch_numbers(homography: NDArray[np.float64], height: int, width: int) -> NDArray[np.intp]:
    """Return which patch each pixel reads, -1 for none, shape (height, width)."""
    rows, columns = np.indices((height, width))
    pixels = np.stack([columns, rows], axis=-1).astype(np.float64)
    at = _through(np.asarray(np.linalg.inv(homography), np.float64), pixels)
    nearest = np.round(at)
    known = places()
    inside = (np.abs(at - nearest) <= CORE / 2.0).all(axis=-1)
    inside &= ((nearest >= 0) & (nearest <= known.max(axis=0))).all(axis=-1)
    number = nearest[..., 0] + (known[:, 0].max() + 1) * nearest[..., 1]
    return np.where(inside, number, -1).astype(np.intp)


def _through(homography: NDArray[np.float64], at: NDArray[np.float64]) -> NDArray[np.float64]:
    ahead = np.concatenate([at, np.ones((*at.shape[:-1], 1))], axis=-1) @ homography.T
    mapped: NDArray[np.float64] = ahead[..., :2] / ahead[..., 2:]
    return mapped
