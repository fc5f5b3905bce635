"""Which directions and pairs a rig can take, and why not the others."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from gonio.clearance import BEYOND_TRAVEL, COLUMNS, ROUND_OFF, ArmsApart, between, limits_of
from gonio.directions import from_spherical
from gonio.errors import BadInputError
from gonio.plan import LeftOut

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from gonio.rig import Axis, Rig
    from planner.candidates import Candidates
    from planner.density import Arm

    Array = NDArray[np.float64]
    Mask = NDArray[np.bool_]

_APPROACH = ", on the approach from one side (approach_deg)"

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
        """Every reason that there is, in the order of the checks."""
        return {name: mask for name, mask in (self.alone | self.together).items() if mask.any()}

    def left_out(
        self, chosen: Mask, omitted: Mapping[str, Mask], *, freely: bool = False
    ) -> tuple[LeftOut, ...]:
        """Say why each pair that is not measured is not, with counts that add up.

        Parameters
        ----------
        chosen
            What a criterion has chosen, shape (L, V). A pair of two directions that could each be
            taken alone counts as lost only where it was chosen.
        omitted
            Pairs that the rig could take and that need not be measured, by reason; each of these
            reasons is told, whether it leaves out any or not.
        freely
            Whether pairs were chosen one by one among those that the rig can take: then all that
            it cannot take count as lost.
        """
        lost = {reason: mask & (chosen | freely) for reason, mask in self.together.items()}
        masks = {**self.alone, **omitted}
        before = np.any([*masks.values(), *lost.values(), chosen], axis=0)
        masks |= {"not chosen": ~before, **lost}
        counts = {reason: int(mask.sum()) for reason, mask in masks.items()}
        return tuple(
            LeftOut(reason=reason, shots=n)
            for reason, n in counts.items()
            if n or reason in omitted
        )


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
    either = {reason: light[reason][:, None] | view[reason] for reason in light}
    pairs = _of_pairs(lights, views, rig)
    reasons = _first_only(either | pairs)
    allowed = ~np.any([*reasons.values()], axis=0)
    if not allowed.any():
        why = ", ".join(reason for reason in pairs if reasons[reason].any())
        raise BadInputError(
            f"all pairs are {why}; correct that in the rig file, or take other directions"
        )
    alone, together = ({name: reasons[name] for name in part} for part in (either, pairs))
    return Reach(allowed, alone, together)


def _first_only(reasons: dict[str, Mask]) -> dict[str, Mask]:
    """Take from each mask what those before it hold."""
    before = np.zeros_like(next(iter(reasons.values())))
    only = {}
    for reason, mask in reasons.items():
        only[reason] = mask & ~before
        before = before | mask
    return only


def _of_arm(
    candidates: Candidates, rig: Rig, arm: Arm, max_theta_deg: float | None
) -> dict[str, Mask]:
    """Return why an arm cannot point at candidates, shape (n,) by reason.

    Raises
    ------
    BadInputError
        When it can point at none.
    """
    low, high = np.array([[axis.min_deg, axis.max_deg] for axis in _axes(rig, arm)]).T
    angles, *starts = _from_one_side(candidates, rig, arm)
    reasons = {BEYOND_TRAVEL: ((angles < low) | (angles > high)).any(axis=1)}
    if max_theta_deg is not None:
        limit = f"beyond the grazing limit of {max_theta_deg:g} deg"
        reasons[limit] = angles[:, 0] > max_theta_deg + ROUND_OFF
    for each in limits_of(rig):
        if each.columns == COLUMNS[arm]:
            short = [each.margin(place) < -ROUND_OFF for place in (angles, *starts)]
            reasons[each.reason] = short[0]
            reasons[each.reason + _APPROACH] = np.any(short, axis=0)
    reasons = _first_only(reasons)
    if np.any([*reasons.values()], axis=0).all():
        why = ", ".join(f"{mask.sum()} {reason}" for reason, mask in reasons.items() if mask.any())
        raise BadInputError(
            f"none of the {len(angles)} directions can be taken by {arm}_theta and {arm}_phi: "
            f"{why}; correct the rig file, or take other directions"
        )
    return reasons


def _of_pairs(lights: Candidates, views: Candidates, rig: Rig) -> dict[str, Mask]:
    """Return why arms that could point at two directions alone cannot together, (L, V)."""
    apart = [limit for limit in limits_of(rig) if isinstance(limit, ArmsApart)]
    if not apart:
        return {}
    least, reason = apart[0].least, apart[0].reason
    light, view = _from_one_side(lights, rig, "light"), _from_one_side(views, rig, "view")
    short = [_too_close(a, b, least) for a, b in product(light, view)]
    return {reason: short[0], reason + _APPROACH: np.any(short, axis=0)}


def _axes(rig: Rig, arm: Arm) -> tuple[Axis, Axis]:
    return rig.axis[f"{arm}_theta"], rig.axis[f"{arm}_phi"]


def _from_one_side(candidates: Candidates, rig: Rig, arm: Arm) -> list[Array]:
    """Return an arm's angles, shape (n, 2), and those at which it may stop just before.

    Axes with an `approach_deg` may start there, one or both of them.
    """
    columns = [
        [angles]
        if not axis.approach_deg
        else [angles, np.clip(angles - axis.approach_deg, axis.min_deg, axis.max_deg)]
        for angles, axis in zip(
            (candidates.theta_deg, candidates.phi_deg), _axes(rig, arm), strict=True
        )
    ]
    return [np.stack(pair, axis=1) for pair in product(*columns)]


def _too_close(light_deg: Array, view_deg: Array, least: float) -> Mask:
    light, view = (from_spherical(*np.radians(angles).T) for angles in (light_deg, view_deg))
    parts = [
        between(light[first : first + _ROWS, None], view[None]) < least - ROUND_OFF
        for first in range(0, len(light), _ROWS)
    ]
    return np.concatenate(parts)
