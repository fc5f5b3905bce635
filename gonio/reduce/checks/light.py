"""A check of the light: whether the lamps were as warm in white frames as in shots."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.checks import Check
from gonio.reduce.causes import faded

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.reduce.checks.seen import Seen
    from gonio.reduce.reading import Reading

CHANGE: Final = 0.01
"""Share by which the lamps' flux may differ from that of the white frames before it is told."""

_UNSTATED = (
    "whether that changes their color nobody stated, and sigma leaves it out: let them warm up "
    "([lamps] warm_up_s in the rig file), or state [uncertainty] lamp_color"
)


def warmth(seen: Sequence[Seen], whites: Sequence[Reading], lamp_color: float) -> Check:
    """Hold the lamps' flux in the shots against that in the white frames.

    Monitors take out how bright a lamp is. That its color changes as well they do not see.

    Parameters
    ----------
    seen, whites
        The shots, and what the white frames say.
    lamp_color
        What the rig file states of it; 0 where it does not.
    """
    flux = [np.mean([reading.flux for reading in each.readings], axis=0) for each in seen]
    of_white = np.mean([reading.flux for reading in whites], axis=0)
    change = float(np.median(faded(np.array(flux), of_white))) if flux else 0.0
    untold = change > CHANGE and not lamp_color
    return Check(
        name="warmth",
        ok=True,
        found=f"the lamps' flux is {change:.1%} from that of the white frames",
        limit=f"{CHANGE:.0%} where lamp_color is not stated",
        remedy=_UNSTATED if untold else "",
        asked=not untold,
    )
