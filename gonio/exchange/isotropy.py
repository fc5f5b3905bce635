"""How isotropic a material is, and the isotropic material next to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.directions import RINGS_81, TWO_PI, paper_angles_deg

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Material

ISOTROPIC_BELOW: Final = 0.01
"""A material that changes less when it is turned is written as an isotropic one."""

_TURNS = 24


def anisotropy_of_grid(values: NDArray[np.float64]) -> float:
    """Return how far pairs differ that turning the sample makes one, from 0 (isotropic) up.

    The mean absolute distance of each value from the mean over the pairs of the same two polar
    angles and the same azimuth between them, relative to the mean of all values. Only nodes of the
    grid are compared, so an isotropic table has exactly none, whatever is interpolated between.

    Parameters
    ----------
    values
        BRDF, shape (81, 81, 3), [light, view, channel].
    """
    kind = _kinds().ravel()
    flat = values.reshape(len(kind), -1)
    count = np.bincount(kind)
    means = np.stack([np.bincount(kind, weights=each) / count for each in flat.T], axis=1)
    scale = float(flat.mean())
    return float(np.abs(flat - means[kind]).mean()) / scale if scale > 0 else 0.0


def _kinds() -> NDArray[np.int64]:
    """Return a number for each pair, one for those that a turn makes equal, shape (81, 81)."""
    theta_deg, phi_deg = paper_angles_deg()
    ring = np.searchsorted([theta for theta, _ in RINGS_81], theta_deg)
    turn = np.rint((phi_deg - phi_deg[:, None]) * 1e3).astype(np.int64) % 360_000
    # at the pole azimuth tells nothing
    turn[ring == 0, :] = 0
    turn[:, ring == 0] = 0
    key = (ring[:, None] * len(RINGS_81) + ring) * 360_000 + turn
    kind: NDArray[np.int64] = np.unique(key, return_inverse=True)[1].reshape(key.shape)
    return kind


@dataclass(frozen=True)
class Averaged:
    """The mean of a material over all turns about its normal."""

    material: Material

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the mean BRDF over 24 turns in 1/sr, shape (..., 3)."""
        total = np.zeros(np.broadcast_shapes(np.shape(light), np.shape(view)))
        for turn in np.arange(_TURNS) * TWO_PI / _TURNS:
            cos, sin = np.cos(turn), np.sin(turn)
            about = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
            total += self.material.evaluate(light @ about, view @ about)
        return total / _TURNS
