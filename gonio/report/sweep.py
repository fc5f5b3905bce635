"""The page of many plans: expected error against time, and which to take for a given night."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.report.drawings import Drawing
from gonio.report.figures import inline_svg, page_style
from gonio.report.grids import Grid, Line, Section
from gonio.report.knee import best_within, knee
from gonio.report.pareto import Point, draw_pareto, pareto_front
from gonio.words import duration

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axis import Axis

    from planner.sweep import Outcome, Sweep

_SIZE_IN = (8.5, 6.2)
_TICKS_S = (
    *(digit * 10.0**decade for decade in range(-3, 2) for digit in (1, 2, 5)),
    *(60.0 * minutes for minutes in (2, 5, 10, 20, 30)),
    *(3600.0 * hours for hours in (1, 2, 4, 8, 24, 72, 168)),
)
_NIGHTS_S = (300.0, 600.0, 1200.0, 1800.0, 3600.0, 7200.0, 4 * 3600.0, 8 * 3600.0)
_ERROR = "expected error: standard deviation of ln(BRDF)"
_HEAD = ("design", "criterion", "shots", "time", "expected error", "planned in (s)")


class Compared:
    """Outcomes side by side: the front, the knee, and what each time is worth.

    Parameters
    ----------
    sweep
        At least one outcome.
    """

    def __init__(self, sweep: Sweep) -> None:
        self.sweep = sweep
        self._outcomes = {_point(each): each for each in sweep.outcomes}
        self.points = list(self._outcomes)
        self.front = [self._outcomes[point] for point in pareto_front(self.points)]
        self._knee = knee(self.points)

    @property
    def knee(self) -> Outcome | None:
        """The design after which more time begins to buy less, where there is one."""
        return self._outcomes[self._knee] if self._knee else None

    def learned(self) -> str:
        """Say in a line which design to take."""
        if self.knee is None:
            return "no knee: more time buys less error at an even rate, as far as this goes"
        return f"the knee: {in_words(self.knee)}"

    def front_grid(self) -> Grid:
        """Return what nobody beats in both time and error."""
        lines = tuple(Line(_cells(each), best=each is self.knee) for each in self.front)
        return Grid("Nobody beats these in both time and error", _HEAD, lines)

    def nights_grid(self) -> Grid:
        """Return the best design for each of some times."""
        lines: list[Line] = []
        for seconds in _NIGHTS_S:
            point = best_within(self.points, seconds)
            if point and (not lines or _cells(self._outcomes[point]) != lines[-1].cells[1:]):
                cells = (duration(seconds), *_cells(self._outcomes[point]))
                lines.append(Line(cells, best=self._outcomes[point] is self.knee))
        return Grid("Which to take for a given time", ("no longer than", *_HEAD), tuple(lines))

    def all_grid(self) -> Grid:
        """Return every design."""
        lines = tuple(Line(_cells(each), best=each is self.knee) for each in self.sweep.outcomes)
        return Grid("Every design", _HEAD, lines)

    def section(self) -> Section:
        """Return the pictures and tables of a page."""
        planning = [_point(each, each.planning_s) for each in self.sweep.outcomes]
        drawings = (
            _drawing("Expected error against acquisition time", self.points,
                     "estimated time on the rig", self._knee),
            _drawing("Expected error against planning time", planning,
                     "time of one core to choose and to order, without the prior's factor", None),
        )  # fmt: skip
        grids = (self.nights_grid(), self.front_grid(), self.all_grid())
        learned = self.learned()
        return Section(learned[0].upper() + learned[1:], drawings, grids, broad=True)


def in_words(outcome: Outcome) -> str:
    """Say a design, its time and its error in a line."""
    what = outcome.design.label + ("" if outcome.design.side else " free pairs")
    return (
        f"{what} by {outcome.design.criterion}, {outcome.shots} shots in "
        f"{duration(outcome.seconds)}, expected error {outcome.error:.3f}"
    )


def _point(outcome: Outcome, seconds: float | None = None) -> Point:
    design = outcome.design
    time_s = outcome.seconds if seconds is None else seconds
    return Point(design.label.replace(" ", ""), time_s, outcome.error, design.criterion)


def _cells(outcome: Outcome) -> tuple[str, ...]:
    design = outcome.design
    return (
        design.label if design.side else f"{design.label} free",
        design.criterion,
        str(outcome.shots),
        duration(outcome.seconds),
        f"{outcome.error:.4f}",
        f"{outcome.planning_s:.2f}",
    )


def _drawing(title: str, points: Sequence[Point], time_name: str, marked: Point | None) -> Drawing:
    with page_style():
        figure = draw_pareto(points, _ERROR, time_name, _SIZE_IN, marked)
        _say_times(figure.axes[0].xaxis)
        svg = inline_svg(figure, title.lower().replace(" ", "-"), title)
    ring = " Ring: the knee." if marked else ""
    caption = (
        "14x14: all pairs of 14 views and 14 lights; 196: pairs chosen freely. Nobody beats those "
        f"on the line in both at once.{ring}"
    )
    return Drawing(title, svg, caption)


def _say_times(axis: Axis) -> None:
    """Label an axis of seconds as a person says times."""
    from matplotlib.ticker import FixedLocator, FuncFormatter

    low, high = axis.get_view_interval()
    axis.set_major_locator(FixedLocator([time for time in _TICKS_S if low <= time <= high]))
    axis.set_major_formatter(FuncFormatter(lambda seconds, _: duration(seconds)))
