"""A check of the light: whether the lamps were as warm in white frames as in shots."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.checks import Check

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

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
    before = np.mean([reading.flux for reading in whites], axis=0)
    changes = [_change(_flux(each), before) for each in seen]
    change = float(np.median(changes)) if changes else 0.0
    untold = change > CHANGE and not lamp_color
    return Check(
        name="warmth",
        ok=True,
        found=f"the lamps' flux is {change:.1%} from that of the white frames",
        limit=f"{CHANGE:.0%} where lamp_color is not stated",
        remedy=_UNSTATED if untold else "",
        asked=not untold,
    )


def _flux(each: Seen) -> NDArray[np.float64]:
    return np.asarray(np.mean([reading.flux for reading in each.readings], axis=0))


def _change(flux: NDArray[np.float64], before: NDArray[np.float64]) -> float:
    """Return by how much lamps that were lit both times changed, each for its share."""
    both = (flux > 0) & (before > 0)
    share = flux[both] / max(flux.sum(), 1e-12)
    return float((share * np.abs(np.log(flux[both] / before[both]))).sum())
