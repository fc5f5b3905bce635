"""Where the shots of a plan lie among the directions that it chose from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from gonio.directions import from_degrees

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.plan import Plan
    from planner.candidates import Candidates

_CHUNK = 1024


def rows_of(
    plan: Plan, side: Literal["light", "view"], candidates: Candidates
) -> NDArray[np.int64]:
    """Return which candidate each shot has on one side: the nearest, shape (shots,)."""
    angles = [(s.axis_deg(f"{side}_theta"), s.axis_deg(f"{side}_phi")) for s in plan.shots]
    at, among = from_degrees(*np.transpose(angles)), candidates.directions
    # in parts: every shot by every candidate would not fit where both are many
    parts = [at[start : start + _CHUNK] @ among.T for start in range(0, len(at), _CHUNK)]
    return np.concatenate([part.argmax(axis=1) for part in parts])
