"""Which directions and pairs a rig can take, and why not the others."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.clearance import BEYOND_TRAVEL, COLUMNS, ROUND_OFF, ArmsApart, between, limits_of
from gonio.errors import BadInputError
from gonio.plan import LeftOut

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import Rig
    from planner.candidates import Candidates
    from planner.density import Arm

    Mask = NDArray[np.bool_]

_ROWS = 256
"""Lights whose angles to all views are in memory at a time."""


@dataclass(frozen=True)
class Reach:
    """The pairs of some lights and some views that a rig can take.

    Attributes
    ----------
    allowed
        Which pairs, shape (L, V).
    alone
        Why others cannot, because of one of their directions, in the order of the checks: masks of
        pairs by reason, shape (L, V). A pair is under its first reason only.
    together
        The same, because of how light and view stand to each other.
    """

    allowed: Mask
    alone: dict[str, Mask]
    together: dict[str, Mask]

    @property
    def reasons(self) -> dict[str, Mask]:
        """Every reason, in the order of the checks."""
        return self.alone | self.together

    def left_out(self, chosen: Mask) -> tuple[LeftOut, ...]:
        """Say why each pair that is not measured is not, with counts that add up.

        Parameters
        ----------
        chosen
            What a criterion has chosen, shape (L, V). A pair of two directions that could each be
            taken alone counts as lost only where it was chosen.
        """
        single = ~np.any([*self.alone.values()], axis=0)
        masks = (
            self.alone
            | {"not chosen at this density": single & ~chosen}
            | {reason: mask & chosen for reason, mask in self.together.items()}
        )
        counts = {reason: int(mask.sum()) for reason, mask in masks.items()}
        return tuple(LeftOut(reason=reason, shots=n) for reason, n in counts.items() if n)


def reach_of(
    lights: Candidates, views: Candidates, rig: Rig, max_theta_deg: float | None = None
) -> Reach:
    """Return which pairs a rig can take (see `gonio.clearance`).

    Parameters
    ----------
    max_theta_deg
        Leave out directions closer to grazing than that, for both arms.

    Raises
    ------
    BadInputError
        When there is none, saying why; or for a limit of theta that is none.
    """
    if max_theta_deg is not None and not 0.0 <= max_theta_deg <= 90.0:
        raise BadInputError(f"max theta is {max_theta_deg:g} deg; give 0 to 90")
    light = _of_arm(lights, rig, "light", max_theta_deg)
    view = _of_arm(views, rig, "view", max_theta_deg)
    free = np.ones((len(lights), len(views)), dtype=bool)
    alone = {}
    for reason in light:
        short = light[reason][:, None] | view[reason]
        alone[reason] = short & free
        free &= ~short
    together = {}
    for limit in limits_of(rig):
        if isinstance(limit, ArmsApart):
            together[limit.reason] = free & _too_close(lights, views, limit.least)
            free = free & ~together[limit.reason]
            if not free.any():
                raise BadInputError(
                    f"all pairs are {limit.reason}; correct that in the rig file, or take more "
                    "directions"
                )
    return Reach(free, alone, together)


def _of_arm(
    candidates: Candidates, rig: Rig, arm: Arm, max_theta_deg: float | None
) -> dict[str, Mask]:
    """Return why an arm cannot point at candidates, shape (n,) by reason."""
    theta, phi = (rig.axis[f"{arm}_{part}"] for part in ("theta", "phi"))
    angles = np.stack([candidates.theta_deg, candidates.phi_deg], axis=1)
    low, high = np.array([[axis.min_deg, axis.max_deg] for axis in (theta, phi)]).T
    reasons = {BEYOND_TRAVEL: ((angles < low) | (angles > high)).any(axis=1)}
    if max_theta_deg is not None:
        limit = f"beyond the grazing limit of {max_theta_deg:g} deg"
        reasons[limit] = angles[:, 0] > max_theta_deg + ROUND_OFF
    for each in limits_of(rig):
        if each.columns == COLUMNS[arm]:
            reasons[each.reason] = each.margin(angles) < -ROUND_OFF
    _refuse_none(reasons, arm)
    return reasons


def _refuse_none(reasons: dict[str, Mask], arm: Arm) -> None:
    count = len(reasons[BEYOND_TRAVEL])
    if np.any([*reasons.values()], axis=0).all():
        why = ", ".join(f"{mask.sum()} {reason}" for reason, mask in reasons.items() if mask.any())
        raise BadInputError(
            f"none of the {count} directions can be taken by {arm}_theta and {arm}_phi: {why}; "
            "correct the rig file, or take other directions"
        )


def _too_close(lights: Candidates, views: Candidates, least: float) -> Mask:
    light, view = lights.directions, views.directions
    parts = [
        between(light[first : first + _ROWS, None], view[None]) < least - ROUND_OFF
        for first in range(0, len(light), _ROWS)
    ]
    return np.concatenate(parts)
