"""Which directions and pairs a rig can take."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from planner.subset import angles_between

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import Rig
    from planner.candidates import Candidates
    from planner.density import Arm

_ROUND_OFF = 1e-9


def within_travel(candidates: Candidates, rig: Rig, arm: Arm) -> NDArray[np.bool_]:
    """Return which candidates both axes of an arm can point at, shape (n,).

    Raises
    ------
    BadInputError
        When there is none.
    """
    theta, phi = rig.axis[f"{arm}_theta"], rig.axis[f"{arm}_phi"]
    within = (theta.min_deg <= candidates.theta_deg) & (candidates.theta_deg <= theta.max_deg)
    within &= (phi.min_deg <= candidates.phi_deg) & (candidates.phi_deg <= phi.max_deg)
    if not within.any():
        raise BadInputError(
            f"none of the {len(candidates)} directions is within the travel of {arm}_theta and "
            f"{arm}_phi; correct min_deg and max_deg in the rig file"
        )
    return within


def apart(lights: Candidates, views: Candidates, rig: Rig) -> NDArray[np.bool_]:
    """Return which pairs keep the rig's `arm.min_separation_deg`, shape (L, V); 0 allows all."""
    least = np.radians(rig.arm.min_separation_deg) - _ROUND_OFF
    return np.asarray(angles_between(lights.directions, views.directions) >= least)


def refuse_keep_out(rig: Rig) -> None:
    """Refuse a rig with boxes that no arm may enter, rather than plan through them.

    Raises
    ------
    BadInputError
        When the rig file has any.
    """
    if rig.arm.keep_out:
        raise BadInputError(
            "arm.keep_out: this version does not plan around boxes; limit the axes' travel "
            "(min_deg, max_deg) in the rig file instead, and leave keep_out empty"
        )
