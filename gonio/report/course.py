"""Error against the rig's time: round by round, and as foretold for fewer shots."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.directions import from_degrees, paper_directions
from gonio.report.drawings import drawing
from gonio.report.expected import FLOOR
from gonio.report.figures import ACCENT, CHANNELS, MUTED, TRUTH, label_decades, new_figure
from gonio.timemodel import estimate

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from typing import Any

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gonio.materials import MeasuredTable
    from gonio.plan import Shot, Side
    from gonio.planchain import PlanChain
    from gonio.protocols import Prior
    from gonio.report.captured import Captured
    from gonio.report.drawings import Drawing
    from gonio.rig import Rig

_FEWEST, _MOST = 8, 512


class Reached(NamedTuple):
    """A time of the rig in seconds, the error there, and after how many shots."""

    seconds: float
    error: float
    shots: int


def rounds_of(chain: PlanChain, captured: Captured) -> list[Reached]:
    """Return the mean posterior standard deviation of ln(f + 0.01 white) after each plan.

    Each plan that goes on from samples says what they left; of the last, the journal does.
    """
    left = [plan.selection.deviation_before for plan in chain.plans[1:]]
    left.append(captured.last_deviation)
    taken = accumulate(len(plan.shots) for plan in chain.plans)
    return [
        Reached(captured.finished_s[plan.sha256], deviation, shots)
        for plan, deviation, shots in zip(chain.plans, left, taken, strict=True)
        if deviation is not None and plan.sha256 in captured.finished_s
    ]


def foretold(chain: PlanChain, rig: Rig, prior: Prior) -> list[Reached]:
    """Return which error a prior expects of fewer and fewer of the shots, and their time.

    Shots that stay are spread evenly over the route, by chance; the error is the root mean square,
    over every twentieth of the 81 x 81 pairs, of the standard deviation of ln(BRDF). Of very many
    shots, only some are asked about.
    """
    from planner.expected import ExpectedError

    shots = chain.shots
    order = np.random.default_rng(0).permutation(len(shots))[:_MOST]
    asked, everywhere = [shots[i] for i in order], _everywhere()
    light = np.concatenate([_directions(asked, "light"), everywhere[0]])
    view = np.concatenate([_directions(asked, "view"), everywhere[1]])
    counts = np.arange(len(light)) >= len(order)
    judge = ExpectedError.at(light, view, counts.astype(np.float64), prior)
    return [
        Reached(
            estimate([shots[i] for i in np.sort(order[:kept])], rig).total_s,
            judge.after(np.arange(kept)),
            kept,
        )
        for kept in _counts(len(order))
    ]


def course_drawings(
    rounds: Sequence[Reached], told: Sequence[Reached], ends: Sequence[tuple[str, Reached]]
) -> Iterator[Drawing]:
    """Draw what there is.

    Parameters
    ----------
    rounds, told
        As of `rounds_of` and `foretold`.
    ends
        What came of it, each with its name.
    """
    if len(rounds) > 1:
        yield drawing(
            "Uncertainty against rig time",
            _draw_rounds(rounds),
            "Mean posterior standard deviation of ln(f + 0.01 white) over the 81 x 81 pairs, "
            "after each plan; numbers: shots.",
        )
    if len(told) > 1:
        yield drawing(
            "Error against rig time, with fewer shots",
            _draw_foretold(told, ends),
            "Standard deviation of ln(f + 0.01 white), root mean square over the 81 x 81 pairs. "
            "Line: foretold by the prior, before anything was measured, for the number of these "
            "shots beside each dot.",
        )


def true_deviation(grid: dict[str, NDArray[Any]], truth: MeasuredTable) -> float:
    """Return the root mean square of the true error of ln(f + 0.01 white)."""
    floor = FLOOR * truth.white
    off = np.log((grid["values"] + floor) / (truth.values + floor))
    return float(np.sqrt(np.mean(off**2)))


def _everywhere() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return light and view of every twentieth pair, which meets each light and each view."""
    grid = paper_directions()
    light, view = np.divmod(np.arange(0, len(grid) ** 2, 20), len(grid))
    return grid[light], grid[view]


def _directions(shots: Sequence[Shot], side: Side) -> NDArray[np.float64]:
    return from_degrees(*np.transpose([shot.direction_deg(side) for shot in shots]))


def _counts(shots: int) -> list[int]:
    """Return all, and halves of them down to few."""
    counts = [shots]
    while counts[-1] >= 2 * _FEWEST:
        counts.append(counts[-1] // 2)
    return counts


def _draw_rounds(rounds: Sequence[Reached]) -> Figure:
    figure, axes, unit_s = _axes(rounds[-1].seconds)
    axes.plot(*_places(rounds, unit_s), "o-", color=ACCENT, markersize=4)
    _say_shots(axes, [rounds[0], rounds[-1]], unit_s)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("mean standard deviation")
    return figure


def _draw_foretold(told: Sequence[Reached], ends: Sequence[tuple[str, Reached]]) -> Figure:
    figure, axes, unit_s = _axes(max(each.seconds for each in [*told, *(end for _, end in ends)]))
    axes.plot(*_places(told, unit_s), "o-", color=ACCENT, markersize=4, label="foretold")
    _say_shots(axes, told, unit_s)
    for (name, end), (color, mark) in zip(ends, ((TRUTH, "D"), (CHANNELS[1], "s")), strict=False):
        axes.plot(end.seconds / unit_s, end.error, mark, color=color, markersize=6, label=name)
    axes.set_yscale("log")
    label_decades(axes.yaxis)
    axes.set_ylabel("standard deviation")
    axes.legend(fontsize=8)
    return figure


def _axes(longest_s: float) -> tuple[Figure, Axes, float]:
    figure = new_figure(4.6, 3.2)
    axes = figure.subplots()
    unit_s, unit = (3600.0, "h") if longest_s > 2 * 3600 else (60.0, "min")
    axes.set_xlim(0.0, 1.08 * longest_s / unit_s)
    axes.margins(y=0.1)
    axes.locator_params("x", nbins=6)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.grid(axis="y", linewidth=0.6)
    axes.set_xlabel(f"rig time ({unit})")
    return figure, axes, unit_s


def _say_shots(axes: Axes, points: Sequence[Reached], unit_s: float) -> None:
    for each in points:
        axes.annotate(
            f"{each.shots}", (each.seconds / unit_s, each.error), xytext=(-3, -3), ha="right",
            va="top", textcoords="offset points", fontsize=7, color=MUTED,
        )  # fmt: skip


def _places(points: Sequence[Reached], unit_s: float) -> tuple[list[float], list[float]]:
    return [each.seconds / unit_s for each in points], [each.error for each in points]
