"""The dynamics study's tables and pictures."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

from gonio.report.drawings import Drawing
from gonio.report.figures import ACCENT, MUTED, SERIES, inline_svg, new_figure, page_style
from gonio.report.grids import Grid, Line

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Run:
    """One integration of the race: its seconds of the processor, and its error in micro-radians.

    `first_seconds` is what the first of its kind took.
    """

    method: str
    tolerance: float
    seconds: float
    first_seconds: float
    error_urad: float
    events: int


@dataclass(frozen=True)
class Bound:
    """What a case was held to, and what was measured."""

    case: str
    what: str
    measured: float
    limit: float
    unit: str
    holds: bool


def race_grid(runs: Sequence[Run]) -> Grid:
    """Return error and time of each run."""
    lines = tuple(
        Line(
            (
                f"{run.method} {run.tolerance:.0e}", f"{run.seconds:.3f}",
                f"{run.first_seconds:.3f}",
                f"{run.error_urad:.2g}", str(run.events),
            ),
            best=False,
        )
        for run in runs
    )  # fmt: skip
    head = ("method and tolerance", "time (s)", "first time (s)", "largest error (µrad)", "events")
    return Grid("One move by every method", head, lines)


def _of(value: float, unit: str) -> str:
    return f"{value:.2g}\N{NO-BREAK SPACE}{unit}".strip()


def bounds_grid(bounds: Sequence[Bound]) -> Grid:
    """Return the cases, each with its bound and whether it holds."""
    lines = tuple(
        Line(
            (
                bound.case, bound.what, _of(bound.measured, bound.unit),
                _of(bound.limit, bound.unit), "pass" if bound.holds else "FAIL",
            ),
            best=not bound.holds,
        )
        for bound in bounds
    )  # fmt: skip
    head = ("case", "what is bounded", "measured", "at most", "")
    return Grid("Extreme cases and their bounds", head, lines, words=True)


def draw_race(runs: Sequence[Run]) -> Drawing:
    """Draw error against run time, a line a method."""
    with page_style():
        figure = new_figure(5.0, 3.6)
        axes = figure.subplots()
        methods = groupby(runs, key=lambda run: run.method)
        for (method, group), (color, mark) in zip(methods, SERIES, strict=False):
            points = [(run.seconds, run.error_urad) for run in group]
            axes.plot(
                *zip(*points, strict=True), f"{mark}-", color=color, markersize=4, label=method
            )
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("processor time (s)")
        axes.set_ylabel("largest error of the load (µrad)")
        axes.grid(linewidth=0.5)
        axes.legend(fontsize=8)
        title = "Error against run time"
        caption = (
            "A move of 29° and two seconds of ringing; each point is a tolerance of the table "
            "below. The truth is DOP853 at 1e-12."
        )
        return Drawing(title, inline_svg(figure, "race", title), caption)


def draw_move(seconds: NDArray[np.float64], off_urad: NDArray[np.float64]) -> Drawing:
    """Draw how far the load is from where it is asked to be."""
    with page_style():
        figure = _trace_figure("load - demand (µrad)")
        figure.axes[0].plot(seconds, off_urad, color=ACCENT)
        title = "A move, and what is left of it"
        caption = (
            "The arm bends while it speeds up and slows down, and swings for seconds after it: "
            "that blurs a frame. Where it rests is set by weight, friction and backlash."
        )
        return Drawing(title, inline_svg(figure, "move", title), caption)


def draw_creep(
    seconds: NDArray[np.float64], asked_urad: NDArray[np.float64], motor_urad: NDArray[np.float64]
) -> Drawing:
    """Draw how a motor that is asked to creep sticks and slips."""
    with page_style():
        figure = _trace_figure("angle (µrad)")
        figure.axes[0].plot(seconds, asked_urad, color=MUTED, label="demand")
        figure.axes[0].plot(seconds, motor_urad, color=ACCENT, label="motor")
        figure.axes[0].legend(fontsize=8)
        title = "Friction near zero speed"
        caption = (
            "Asked for 0.2 mrad/s by a soft servo, the motor sticks until the torque exceeds the "
            "friction at rest, and slips. While it sticks it does not move at all."
        )
        return Drawing(title, inline_svg(figure, "creep", title), caption)


def _trace_figure(what: str) -> Figure:
    figure = new_figure(5.0, 3.2)
    axes = figure.subplots()
    axes.set_xlabel("time (s)")
    axes.set_ylabel(what)
    axes.grid(linewidth=0.5)
    return figure
