"""Vignetting: the picture's edges are darker than its middle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import CameraSpec


def natural_falloff(spec: CameraSpec) -> NDArray[np.float64]:
    """Return what the fourth power of the cosine of the field angle leaves, shape (h, w).

    It holds for a thin lens (Kingslake 1992).
    """
    falloff: NDArray[np.float64] = (1.0 + _square_px(spec) / spec.focal_px**2) ** -2.0
    return falloff


def optical_falloff(spec: CameraSpec, loss: float) -> NDArray[np.float64]:
    """Return what the lens' own rims leave: 1 - loss (r / R)^2, shape (height, width).

    The first term of the even polynomial by which vignetting is commonly described (Goldman 2010).

    Parameters
    ----------
    spec
        The camera; r is a pixel's distance from its centre, R that of the farthest pixel.
    loss
        Of the farthest pixel, 0 to 1.
    """
    square = _square_px(spec)
    falloff: NDArray[np.float64] = 1.0 - loss * square / square.max()
    return falloff


def _square_px(spec: CameraSpec) -> NDArray[np.float64]:
    x, y = spec.centre_px
    across, down = np.arange(spec.width) - x, np.arange(spec.height) - y
    square: NDArray[np.float64] = across**2 + down[:, None] ** 2
    return square
