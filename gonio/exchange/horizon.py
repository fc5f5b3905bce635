"""Files hold values where directions lie behind the sample; those at the horizon stand in."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.directions import normalize

if TYPE_CHECKING:
    from numpy.typing import NDArray

LOWEST: Final = float(np.cos(np.radians(89.0)))
"""Cosine of the most grazing direction that a material is asked for."""


def above_horizon(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Lift directions, shape (n, 3), that lie beyond 89 deg to 89 deg, each in its azimuth."""
    low = direction[:, 2] < LOWEST
    # the nadir has no azimuth
    flat = np.where(np.abs(direction[:, :2]).max(axis=1) > 0, direction[:, 0], 1.0)
    lying = normalize(np.stack([flat, direction[:, 1], np.zeros(len(flat))], axis=1))
    lifted = lying * np.sqrt(1.0 - LOWEST**2) + [0.0, 0.0, LOWEST]
    return np.where(low[:, None], lifted, direction)
