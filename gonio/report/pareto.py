"""Error against time: who gives the most for it, with every point labeled."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.report.figures import ACCENT, INK, MUTED, SERIES, label_decades, new_figure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

_LABEL_PT = 7.0
_WIDTH_OF_LETTER = 0.56
_REACH_PT = (5.0, 12.0, 20.0, 30.0, 42.0, 56.0)
_SIDES = 16
_LEAST, _LEAST_SHARE = 1e-6, 1e-4


@dataclass(frozen=True)
class Point:
    """One competitor: its name, its seconds and its error, neither below zero; its kind, if any."""

    name: str
    seconds: float
    error: float
    group: str = ""


def draw_pareto(
    points: Sequence[Point],
    error_name: str,
    time_name: str,
    size_in: tuple[float, float] = (5.4, 4.0),
    knee: Point | None = None,
) -> Figure:
    """Draw error against time on logarithmic axes; nobody beats those on the line in both.

    Parameters
    ----------
    points
        At least one. What is less than a ten-thousandth of the largest is drawn there, since a
        logarithmic axis has no zero.
    error_name, time_name
        What the axes say.
    size_in
        Width and height: the fewer the points, the smaller, and the larger what is written.
    knee
        The one to mark.
    """
    figure = new_figure(*size_in)
    axes = figure.subplots()
    points = _off_zero(points)
    best = pareto_front(points)
    _draw_points(axes, points, best)
    if knee:
        axes.plot(
            knee.seconds, knee.error, "o", markersize=12, markerfacecolor="none",
            markeredgecolor=INK, markeredgewidth=1.2,
        )  # fmt: skip
    seconds, errors = _places(points)
    for axis, values in (("x", seconds), ("y", errors)):
        _scale(axes, axis, values)
    axes.set_xlabel(time_name)
    axes.set_ylabel(error_name)
    axes.grid(linewidth=0.5)
    figure.draw_without_rendering()
    _label(axes, figure.dpi / 72.0, points, best)
    return figure


def _draw_points(axes: Axes, points: Sequence[Point], best: Sequence[Point]) -> None:
    """Draw the points, each kind in a color of its own if there are several, and the line."""
    groups = list(dict.fromkeys(point.group for point in points))
    if len(groups) == 1:
        axes.plot(*_places(points), "o", color=MUTED, markersize=4)
        axes.plot(*_places(best), "o-", color=ACCENT, markersize=5)
        return
    axes.plot(*_places(best), "-", color=MUTED, linewidth=0.8, zorder=1)
    for group, (color, mark) in zip(groups, cycle(SERIES), strict=False):
        of_group = [point for point in points if point.group == group]
        axes.plot(*_places(of_group), mark, color=color, markersize=4.5, label=group)
    # errors fall with time; to look for the best place may take long, and is then warned of
    axes.legend(fontsize=_LABEL_PT, loc="upper right")


def _places(points: Sequence[Point]) -> tuple[list[float], list[float]]:
    return [point.seconds for point in points], [point.error for point in points]


def pareto_front(points: Sequence[Point]) -> list[Point]:
    """Return the points that no other beats in both time and error, by time."""
    front: list[Point] = []
    for point in sorted(points, key=lambda p: (p.seconds, p.error)):
        if not front or point.error < front[-1].error:
            front.append(point)
    return front


def _off_zero(points: Sequence[Point]) -> list[Point]:
    """Return points that a logarithmic axis can show, and that leave room for the others."""
    least_seconds, least_error = (
        max(_LEAST, _LEAST_SHARE * max(getattr(p, field) for p in points))
        for field in ("seconds", "error")
    )
    return [
        replace(p, seconds=max(p.seconds, least_seconds), error=max(p.error, least_error))
        for p in points
    ]


def _scale(axes: Axes, axis: str, values: Sequence[float]) -> None:
    low, high = min(values), max(values)
    # room for the labels
    margin = max((high / low) ** 0.12, 1.15)
    if axis == "x":
        axes.set_xscale("log")
        axes.set_xlim(low / margin, high * margin)
        label_decades(axes.xaxis)
    else:
        axes.set_yscale("log")
        axes.set_ylim(low / margin, high * margin)
        label_decades(axes.yaxis)


def _label(axes: Axes, per_pt: float, points: Sequence[Point], best: Sequence[Point]) -> None:
    """Put each name where it covers least: near its point first, farther with a line to it."""
    at, line = (
        axes.transData.transform([(p.seconds, p.error) for p in each]) / per_pt
        for each in (points, best)
    )
    inside = np.array(axes.bbox.extents) / per_pt
    taken = [np.array([x - 3, y - 3, x + 3, y + 3]) for x, y in at]
    taken += [np.array([x - 1, y - 1, x + 1, y + 1]) for x, y in _along(line)]
    for point, place in zip(points, at, strict=True):
        offset, box = _free_place(place, point.name, np.array(taken), inside)
        taken.append(box)
        far = np.hypot(*offset) > _REACH_PT[1]
        axes.annotate(
            point.name, (point.seconds, point.error), xytext=(offset[0], offset[1]),
            textcoords="offset points", ha="center", va="center", fontsize=_LABEL_PT,
            color=INK if point in best else MUTED,
            arrowprops={"arrowstyle": "-", "color": MUTED, "linewidth": 0.4} if far else None,
        )  # fmt: skip


def _along(line: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points of a polyline, so close that no letter fits in between."""
    steps = np.linspace(0.0, 1.0, 100)[:, None, None]
    return (line[:-1] + steps * np.diff(line, axis=0)).reshape(-1, 2)


def _free_place(
    place: NDArray[np.float64], name: str, taken: NDArray[np.float64], inside: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the offset of a label's centre from its point, and its box, in points."""
    half = np.array([0.5 * _WIDTH_OF_LETTER * _LABEL_PT * len(name) + 1, 0.6 * _LABEL_PT])
    candidates: list[tuple[float, int, Any, Any]] = []
    for reach in _REACH_PT:
        for angle in 2.0 * np.pi * np.arange(_SIDES) / _SIDES:
            side = np.array([np.cos(angle), np.sin(angle)])
            offset = side * (reach + half * np.abs(side))
            box = np.concatenate([place + offset - half, place + offset + half])
            cost = _covered(box, taken) + 3.0 * _outside(box, inside) + reach
            candidates.append((cost, len(candidates), offset, box))
    _, _, offset, box = min(candidates, key=lambda each: each[:2])
    return offset, box


def _covered(box: NDArray[np.float64], others: NDArray[np.float64]) -> float:
    width = np.minimum(box[2], others[:, 2]) - np.maximum(box[0], others[:, 0])
    height = np.minimum(box[3], others[:, 3]) - np.maximum(box[1], others[:, 1])
    return float((width.clip(0) * height.clip(0)).sum())


def _outside(box: NDArray[np.float64], inside: NDArray[np.float64]) -> float:
    over = np.concatenate([inside[:2] - box[:2], box[2:] - inside[2:]])
    return float(100.0 * over.clip(0).sum())
