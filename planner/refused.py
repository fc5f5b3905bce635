"""Which pairs a rig cannot take, by reason."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from planner.reach import apart, within_travel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import Rig
    from planner.candidates import Candidates


def refused_pairs(lights: Candidates, views: Candidates, rig: Rig) -> dict[str, NDArray[np.bool_]]:
    """Return the pairs that `rig` cannot take, shape (L, V) each, by reason; no pair is in two.

    Raises
    ------
    BadInputError
        When the rig can take no direction of one side.
    """
    reach = np.outer(within_travel(lights, rig, "light"), within_travel(views, rig, "view"))
    close = f"closer than {rig.arm.min_separation_deg:g} deg (arm.min_separation_deg)"
    return {
        "beyond the travel of an axis": ~reach,
        close: reach & ~apart(lights, views, rig),
    }
