"""The directions that a plan chooses from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.directions import from_degrees, paper_angles_deg

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Candidates:
    """A set of directions, the same for views and lights.

    Attributes
    ----------
    name
        As the plan records it.
    theta_deg, phi_deg
        Angles in degrees, shape (n,) each.
    """

    name: str
    theta_deg: NDArray[np.float64]
    phi_deg: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.theta_deg)

    @property
    def directions(self) -> NDArray[np.float64]:
        """Unit vectors, shape (n, 3)."""
        return from_degrees(self.theta_deg, self.phi_deg)


def paper_candidates() -> Candidates:
    """Return the paper's 81 directions, the pole first (see `gonio.directions.RINGS_81`)."""
    return Candidates("paper-81", *paper_angles_deg())
