"""Which pairs a model is least sure of."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.directions import paper_angles_deg, paper_directions
from gonio.report.expected import relative_sigma

if TYPE_CHECKING:
    from numpy.typing import NDArray

_COUNT = 6
_APART_DEG = 25.0


class NextPair(NamedTuple):
    """A pair and how unsure the model is of it.

    Attributes
    ----------
    angles_deg
        Polar angle and azimuth of the light, then of the view.
    relative
        Standard uncertainty over value, mean of the channels.
    """

    angles_deg: tuple[float, float, float, float]
    relative: float


def next_pairs(grid: dict[str, NDArray[np.float32]], white: float) -> list[NextPair]:
    """Return the six pairs of largest relative uncertainty, each away from those before it.

    Away means by 25 degrees in light or view, from the pair and from its reverse.

    Parameters
    ----------
    grid
        `values` and `sigma` on the 81 x 81 grid, shape (81, 81, 3).
    white
        A hundredth of it is added to the values, 1/sr: nobody asks for a tenth of nothing.
    """
    relative = relative_sigma(grid, white)
    cosine = paper_directions() @ paper_directions().T
    near = cosine > np.cos(np.radians(_APART_DEG))
    left, chosen = relative.copy(), []
    for _ in range(_COUNT):
        light, view = np.unravel_index(int(np.argmax(left)), left.shape)
        chosen.append((int(light), int(view), float(relative[light, view])))
        around = near[light][:, None] & near[view][None]
        left[around | around.T] = -np.inf
    theta, phi = paper_angles_deg()
    return [
        NextPair((theta[light], phi[light], theta[view], phi[view]), value)
        for light, view, value in chosen
    ]
