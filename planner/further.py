"""Further plans of a session: they go on from shots that were measured, or are on their way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.directions import from_degrees
from gonio.errors import BadInputError, NothingLeftError
from gonio.timemodel import estimate
from planner.candidates import paper_candidates
from planner.make import field_within, make_plan

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.plan import Plan, Shot
    from gonio.rig import Rig
    from planner.field import Field

MEASURED = "measured or planned before, as they are or reversed"
"""Why a pair is left out."""

# far below the spacing of any directions, far above round-off of their angles
_SAME = np.cos(np.radians(0.01))


@dataclass(frozen=True)
class Before:
    """What a further plan goes on from.

    Attributes
    ----------
    parent
        SHA-256 of the plan before it.
    next_index
        Of its first shot.
    shots
        Those before it that need not be measured again.
    reverses
        Whether their reverses need not be measured either.
    calibrated_s
        Exposures of which dark and white frames are there, in seconds.
    at_deg
        Where the axes stand, where the capture goes on at once; None: they will have to be homed.
    """

    parent: str
    next_index: int
    shots: Sequence[Shot]
    reverses: bool = True
    calibrated_s: tuple[float, ...] = ()
    at_deg: tuple[float, ...] | None = None

    def known(self, field: Field) -> NDArray[np.bool_]:
        """Return which pairs of a field need not be measured again, shape (L, V)."""
        light, view = (_directions(self.shots, side) for side in ("light", "view"))
        known = _at(field, light, view)
        return known | _at(field, view, light) if self.reverses else known


def make_further_plan(
    rig: Rig, before: Before, shots: int, *, exactly: bool = False, **choice: Any
) -> Plan:
    """Choose pairs among those that were not measured, and count their shots on.

    Parameters
    ----------
    rig
        What will measure.
    before
        What was measured.
    shots
        How many pairs; of fewer that are left, all.
    exactly
        Rather refuse where fewer are left.
    choice
        More of `planner.make.make_plan`.

    Raises
    ------
    gonio.errors.NothingLeftError
        When all that the rig can take was measured.
    gonio.errors.BadInputError
        As `planner.make.make_plan`.
    """
    lights, views = (
        choice.get(f"{side}_candidates") or paper_candidates() for side in ("light", "view")
    )
    field = field_within(rig, lights, views, choice.get("max_theta_deg"), {})
    left = int((field.allowed & ~before.known(field)).sum())
    if not left:
        raise NothingLeftError
    if exactly and shots > left:
        raise BadInputError(f"shots is {shots}; give 1 to {left}, all pairs that are left to take")
    plan = make_plan(rig, shots=min(shots, left), leave_out={MEASURED: before.known}, **choice)
    counted = tuple(
        shot.model_copy(update={"index": before.next_index + shot.index}) for shot in plan.shots
    )
    estimates = estimate(counted, rig, choice.get("timing"), before.calibrated_s, before.at_deg)
    return plan.model_copy(
        update={"parent": before.parent, "shots": counted, "estimates": estimates}
    )


def _directions(shots: Sequence[Shot], side: str) -> NDArray[np.float64]:
    theta_deg, phi_deg = (
        np.array([shot.axis_deg(f"{side}_{angle}") for shot in shots], np.float64)
        for angle in ("theta", "phi")
    )
    return from_degrees(theta_deg, phi_deg)


def _at(field: Field, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which pairs of a field some pairs are, shape (L, V)."""
    lights, views = (
        (each.directions @ some.T > _SAME).astype(np.int64)
        for each, some in ((field.lights, light), (field.views, view))
    )
    return np.asarray(lights @ views.T > 0)
