"""The full well: near it a pixel gathers less than all electrons."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from sim.sensor import FULL_WELL_E

if TYPE_CHECKING:
    from numpy.typing import NDArray

LARGEST_SHORTFALL: Final = 0.08
"""Beyond it the curve would fall again before it is full."""


def gathered(electrons: NDArray[np.float64], shortfall: float) -> NDArray[np.float64]:
    """Return the electrons that a pixel gathers of those that light and heat make.

    With x the electrons over the full well it is x (1 - shortfall x^4): a line at low signal that
    bends near the full well, as photon transfer curves do (Janesick 2007); the power is
    chosen, so that half a well lacks a sixteenth of what a full one does.

    Parameters
    ----------
    electrons
        Shape (...).
    shortfall
        Share that is missing where the full well would just be reached, up to 0.08.
    """
    if shortfall == 0.0:
        return electrons
    # the curve's highest point, which is above the full well
    highest = (5.0 * shortfall) ** -0.25
    fill = np.minimum(electrons / FULL_WELL_E, highest)
    # NumPy's power takes ten times as long
    square = fill * fill
    bent: NDArray[np.float64] = FULL_WELL_E * fill * (1.0 - shortfall * square * square)
    return bent
