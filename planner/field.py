"""The pairs that a plan chooses from: every light with every view, and what of them counts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from planner.candidates import paper_candidates

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from planner.candidates import Candidates

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class Field:
    """All pairs of some lights and some views.

    Attributes
    ----------
    lights, views
        L and V directions; the two sets may differ.
    allowed
        Which pairs the rig can take, shape (L, V).
    demand
        How much each pair counts, shape (L, V), not negative; None: all alike.
    """

    lights: Candidates
    views: Candidates
    allowed: NDArray[np.bool_]
    demand: Array | None = None

    @property
    def pairs(self) -> tuple[Array, Array]:
        """Unit vectors of light and view of each pair, shape (L V, 3) each, light by light."""
        lights, views = self.lights.directions, self.views.directions
        return np.repeat(lights, len(views), axis=0), np.tile(views, (len(lights), 1))

    def reciprocal(self, measured: NDArray[np.bool_]) -> int:
        """Count the unordered pairs of different directions that are measured both ways round.

        Parameters
        ----------
        measured
            Shape (L, V).
        """
        both = np.concatenate([self.lights.directions, self.views.directions]).round(9) + 0.0
        _, which = np.unique(both, axis=0, return_inverse=True)
        lights, views = np.split(which.reshape(-1), [len(self.lights)])
        light, view = np.nonzero(measured)
        there = set(zip(lights[light].tolist(), views[view].tolist(), strict=True))
        return sum((b, a) in there for a, b in there if a < b)


def paper_field() -> Field:
    """Return all 6561 pairs of the paper's 81 directions."""
    candidates = paper_candidates()
    return Field(candidates, candidates, np.ones((len(candidates), len(candidates)), bool))


def cosine_demand(lights: Candidates, views: Candidates) -> Array:
    """Return cos(theta_light) cos(theta_view), how large a pair's surface looks, shape (L, V)."""
    cosines = (np.cos(np.radians(each.theta_deg)).clip(0.0) for each in (lights, views))
    return np.asarray(np.multiply.outer(*cosines))
