"""The 81 x 81 map: light along one axis, view along the other, as a picture."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import RINGS_81, paper_directions
from gonio.report.figures import new_figure
from gonio.samples import WHITE_PER_MEDIAN
from nnbrdf.sphere import encode_srgb

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gonio.samples import Samples

_SIDE_IN = 4.2
_ENLARGEMENTS = (1, 2, 5, 10, 20, 50, 100)


def draw_map(values: NDArray[np.float64], white: float) -> Figure:
    """Draw values as a picture, exposed so that white is white; NaN is left open.

    Parameters
    ----------
    values
        1/sr, shape (81, 81, 3), [light, view, channel].
    white
        What is as bright as can be shown, in 1/sr.
    """
    figure = new_figure(_SIDE_IN, _SIDE_IN)
    axes = figure.subplots()
    known = np.isfinite(values).all(axis=-1, keepdims=True)
    color = encode_srgb(np.where(known, values, 0.0) / white)
    axes.imshow(np.concatenate([color, known], axis=-1), interpolation="none")
    _mark_rings(axes)
    return figure


def enlargement(difference: NDArray[np.float64], white: float) -> int:
    """Return by how much to enlarge an absolute difference to be exposed as the material is."""
    # the body of the material is a quarter of white, so the mean difference may be as much
    mean = float(difference.mean())
    fitting = [factor for factor in _ENLARGEMENTS if factor * mean <= white / WHITE_PER_MEDIAN]
    return max(fitting, default=1)


def measured_map(samples: Samples) -> NDArray[np.float64]:
    """Return samples at their nearest pair of the grid, NaN elsewhere, shape (81, 81, 3)."""
    grid = paper_directions()
    light, view = (np.argmax(at @ grid.T, axis=1) for at in (samples.light, samples.view))
    values = np.full((len(grid), len(grid), 3), np.nan)
    values[light, view] = samples.value
    return values


def _mark_rings(axes: Axes) -> None:
    """Label each ring by its theta, and part it from the next."""
    ends = list(accumulate(count for _, count in RINGS_81))
    middles = [end - count / 2 - 0.5 for (_, count), end in zip(RINGS_81, ends, strict=True)]
    names = [f"{theta:g}" for theta, _ in RINGS_81]
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_ticks(middles, names, fontsize=7)
        axis.set_ticks([end - 0.5 for end in ends[:-1]], minor=True)
        axis.set_tick_params(which="major", length=0, pad=6)
        axis.set_tick_params(which="minor", length=4)
    axes.spines[:].set_visible(False)
    axes.set_xlabel("view: θ of the ring (deg), φ rising within")
    axes.set_ylabel("light: θ of the ring (deg), φ rising within")
