"""How the error fell while training, and how the model meets what was measured."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.report.figures import ACCENT, CHANNELS, LINE, MUTED, label_decades, new_figure
from gonio.report.summary import at_samples

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gonio.materials import MeasuredTable
    from gonio.samples import Samples
    from nnbrdf.history import History
    from nnbrdf.load import Model

_LEAST = 1e-3
_MANY = 2000


def draw_training(history: History, truth: MeasuredTable | None) -> Figure:
    """Draw eps8 against seconds where the truth is known, else the loss: each network, median."""
    figure = new_figure(4.6, 3.4)
    axes = figure.subplots()
    seconds = [point.seconds for point in history.checkpoints]
    errors = _losses(history) if truth is None else _errors(history, truth)
    axes.plot(seconds, errors, color=MUTED, linewidth=0.6, alpha=0.6)
    axes.plot(seconds, np.median(errors, axis=1), color=ACCENT, label="median of the networks")
    axes.set_xscale("log")
    label_decades(axes.xaxis)
    axes.set_ylim(bottom=0.0)
    axes.grid(axis="y", linewidth=0.6)
    axes.set_xlabel("training time (s)")
    axes.set_ylabel("loss (units of white)" if truth is None else "eps8 (8-bit steps)")
    axes.legend(fontsize=8, loc="upper right")
    return figure


def _losses(history: History) -> NDArray[np.float64]:
    """Return shape (checkpoints, members)."""
    return np.array([point.loss for point in history.checkpoints])


def _errors(history: History, truth: MeasuredTable) -> NDArray[np.float64]:
    """Return eps8, shape (checkpoints, members)."""
    from nnbrdf.metrics import eps8

    return np.array(
        [
            [eps8(member, truth.values, truth.white) for member in history.grids(index)]
            for index in range(len(history))
        ]
    )


def draw_scatter(estimate: Model, samples: Samples) -> Figure:
    """Draw the model against the samples, channel by channel, on logarithmic axes."""
    figure = new_figure(4.2, 3.4)
    axes = figure.subplots()
    least = _LEAST * samples.white
    told, measured = at_samples(estimate, samples).clip(least), samples.value.clip(least)
    ends = [min(told.min(), measured.min()), max(told.max(), measured.max())]
    axes.plot(ends, ends, color=MUTED, linewidth=0.8)
    axes.axvline(samples.white, color=LINE, linewidth=0.8, zorder=0)
    for channel, color in enumerate(_colors(len(samples.channels))):
        # thousands of dots as a picture: as lines they would fill the page
        axes.plot(
            measured[:, channel], told[:, channel], "o", color=color, markersize=3, alpha=0.5,
            markeredgewidth=0, rasterized=samples.value.size > _MANY,
        )  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        label_decades(axis)
    axes.set_xlabel("measured (1/sr)")
    axes.set_ylabel("model (1/sr)")
    return figure


def _colors(channels: int) -> tuple[str, ...]:
    return CHANNELS if channels == len(CHANNELS) else (ACCENT,) * channels
