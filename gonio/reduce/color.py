"""From the camera's channels to linear sRGB."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.color import XYZ_FROM_SRGB
from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

COLOR_SPACE: Final = "linear sRGB"


def camera_from_srgb(color_matrix: Sequence[float]) -> NDArray[np.float64]:
    """Return the matrix, shape (3, 3), from linear sRGB to white-balanced camera RGB.

    It is ColorMatrix1 x `XYZ_FROM_SRGB` with each row scaled to a sum of one, so that a grey has
    equal channels on both sides.

    Parameters
    ----------
    color_matrix
        ColorMatrix1, XYZ to camera, nine numbers row by row.

    Raises
    ------
    gonio.errors.BadInputError
        When it cannot be inverted.
    """
    camera = np.reshape(color_matrix, (3, 3)) @ XYZ_FROM_SRGB
    white = camera.sum(axis=1, keepdims=True)
    balanced: NDArray[np.float64] = camera / np.where(white > 0, white, np.nan)
    # past a hundred, noise would drown every color
    if not (np.isfinite(balanced).all() and np.linalg.cond(balanced) < 100.0):
        raise BadInputError(
            "the frames' ColorMatrix1 does not tell colors apart; set the camera's matrix in its "
            "DNG files"
        )
    return balanced
