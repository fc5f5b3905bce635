"""From the camera's channels to linear sRGB."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

COLOR_SPACE: Final = "linear sRGB"

XYZ_FROM_SRGB: Final = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
"""Linear sRGB to CIE XYZ under D65 (primaries and white of IEC 61966-2-1)."""


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
