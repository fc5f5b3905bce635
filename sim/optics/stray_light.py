"""Stray light: of what comes through the lens some falls where it does not belong."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def veiling_glare(image: NDArray[np.float64], share: float) -> NDArray[np.float64]:
    """Spread a share of all light evenly over the frame, channel by channel.

    It is what reflections between the lenses' surfaces come to (ISO 9358:1994; the share is about
    the veiling glare index for a bright field as large as the frame).

    Parameters
    ----------
    image
        Shape (height, width, 3).
    share
        Of the light, 0 to 1.
    """
    veiled: NDArray[np.float64] = (1.0 - share) * image + share * image.mean(axis=(0, 1))
    return veiled


def halo(image: NDArray[np.float64], share: float, sigma_px: float) -> NDArray[np.float64]:
    """Spread a share of each pixel's light about it, as dust and scratches on glass do.

    Parameters
    ----------
    image
        Shape (height, width, 3).
    share
        Of the light, 0 to 1.
    sigma_px
        Standard deviation of the halo along rows and along columns.
    """
    spread: NDArray[np.float64] = (1.0 - share) * image + share * _bell(image, sigma_px)
    return spread


def _bell(image: NDArray[np.float64], sigma_px: float) -> NDArray[np.float64]:
    """Blur by nearly a Gaussian: three boxes in turn, whose cost does not grow with their width.

    Each box of w pixels has a variance of (w^2 - 1) / 12. What would leave the frame is mirrored
    into it, so that no light is lost.
    """
    import cv2

    width = 2 * round(math.sqrt(4.0 * sigma_px**2 + 1.0) / 2.0 - 0.5) + 1
    for _ in range(3):
        boxed = cv2.boxFilter(image, -1, (width, width), borderType=cv2.BORDER_REFLECT)
        image = np.asarray(boxed, np.float64)
    return image
