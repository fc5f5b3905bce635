"""How a pair of directions becomes the inputs of a network, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Encoding = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


def encode_xyz(light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return both unit vectors, the view's x, y, z first, then the light's.

    Parameters
    ----------
    light, view
        Unit vectors, shape (n, 3) each.

    Returns
    -------
    ndarray
        Shape (n, 6).
    """
    return np.concatenate([view, light], axis=-1)


ENCODINGS: dict[str, Encoding] = {"xyz": encode_xyz}
"""Each maps light and view, shapes (n, 3), to inputs, shape (n, inputs)."""

INPUTS = {"xyz": 6}
"""How many inputs each encoding has."""
