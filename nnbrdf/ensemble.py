"""Several networks as reflectance: directions in, 1/sr out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import paper_directions
from nnbrdf.encoding import ENCODINGS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nnbrdf.network import Networks

GRID_CHANNELS = 3


@dataclass(frozen=True)
class Ensemble:
    """Networks that were trained on values over white, and what their inputs are.

    Attributes
    ----------
    networks
        The members.
    encoding
        A name of `nnbrdf.encoding.ENCODINGS`.
    white
        What an output of 1 means, in 1/sr.
    """

    networks: Networks
    encoding: str
    white: float

    def predict(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what each member says, below zero where it says so.

        Parameters
        ----------
        light, view
            Unit vectors, shape (n, 3) each.

        Returns
        -------
        ndarray
            1/sr, shape (members, n, 3); a single channel is repeated.
        """
        values = self.white * self.networks.forward(ENCODINGS[self.encoding](light, view))
        return np.broadcast_to(values, (*values.shape[:2], GRID_CHANNELS))

    def member(self, index: int) -> Ensemble:
        """Return one member alone."""
        return Ensemble(self.networks.member(index), self.encoding, self.white)


def grid_pairs() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return light and view of the 81 x 81 grid, shape (81, 81, 3) each, [light, view]."""
    directions = paper_directions()
    light, view = np.broadcast_arrays(directions[:, None], directions[None])
    return light, view
