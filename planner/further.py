"""What a further plan of a session goes on from: shots that were measured, or are on their way."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.directions import from_degrees

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.plan import Shot
    from planner.field import Field

# far below the spacing of any directions, far above round-off of their angles
_SAME = np.cos(np.radians(0.01))


class Further(NamedTuple):
    """Where a plan goes on.

    Attributes
    ----------
    parent
        SHA-256 of the plan before it; None where there is none.
    first_index
        Of its first shot.
    shots
        Those before it that need not be measured again.
    reverses
        Whether their reverses need not be measured either.
    calibrated_s
        Exposures of which dark and white frames are there, in seconds.
    """

    parent: str | None = None
    first_index: int = 0
    shots: Sequence[Shot] = ()
    reverses: bool = True
    calibrated_s: tuple[float, ...] = ()

    def known(self, field: Field) -> NDArray[np.bool_]:
        """Return which pairs of a field need not be measured again, shape (L, V)."""
        known = np.zeros(field.allowed.shape, bool)
        if not self.shots:
            return known
        light, view = (_directions(self.shots, side) for side in ("light", "view"))
        for there, back in ((light, view), (view, light))[: 1 + self.reverses]:
            at_light, at_view = (
                _same(field.lights.directions, there),
                _same(field.views.directions, back),
            )
            known |= (at_light.astype(int) @ at_view.T.astype(int)) > 0
        return known


def _directions(shots: Sequence[Shot], side: str) -> NDArray[np.float64]:
    theta_deg, phi_deg = (
        np.array([shot.axis_deg(f"{side}_{angle}") for shot in shots]) for angle in ("theta", "phi")
    )
    return from_degrees(theta_deg, phi_deg)


def _same(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.asarray(a @ b.T > _SAME)
