"""Which directions were chosen, and which were skipped."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from gonio.directions import from_degrees, paper_directions
from gonio.report.figures import new_figure
from gonio.report.hemisphere import draw_hemisphere

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure
    from matplotlib.projections.polar import PolarAxes
    from numpy.typing import NDArray

    from gonio.plan import Plan, Side
    from gonio.samples import Samples


def draw_chosen(chosen: NDArray[np.float64], candidates: NDArray[np.float64]) -> Figure:
    """Draw a hemisphere of chosen directions, shape (n, 3), among candidates, shape (m, 3)."""
    figure = new_figure(3.2, 3.2)
    axes = figure.add_subplot(projection="polar")
    draw_hemisphere(cast("PolarAxes", axes), chosen, candidates, "")
    return figure


def planned(chain: Sequence[Plan], side: Side) -> NDArray[np.float64]:
    """Return the directions of one side ("view", "light") that plans hold, shape (n, 3)."""
    angles = {shot.direction_deg(side) for plan in chain for shot in plan.shots}
    return from_degrees(*np.array(sorted(angles)).T)


def measured(samples: Samples, side: str) -> NDArray[np.float64]:
    """Return the directions of one side that samples hold, alike ones once, shape (n, 3)."""
    # a thousandth is well above the repeatability of an arm and below any spacing of directions
    distinct: NDArray[np.float64] = np.unique(getattr(samples, side).round(3), axis=0)
    return distinct


def candidates_of(chain: Sequence[Plan]) -> NDArray[np.float64]:
    """Return what plans chose from, shape (m, 3); empty where there is no plan."""
    return paper_directions() if chain else np.empty((0, 3))
