"""Error against the number of shots, as part of a study's page."""

from __future__ import annotations

from statistics import mean
from typing import TYPE_CHECKING

from gonio.report.drawings import Drawing
from gonio.report.figures import SERIES, inline_svg, label_decades, new_figure, page_style
from gonio.report.grids import Grid, Line, Section, identifier
from gonio.report.pareto import Point, draw_pareto

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from nnbrdf.studies.shots import Shot

_PAIRS = 81 * 81


def shots_section(title: str, shots: Sequence[Shot]) -> Section:
    """Return one material, or the means over several: two pictures of each metric and a table.

    Parameters
    ----------
    title
        Of the section.
    shots
        Of one material, or of all; those of one method and number are averaged.
    """
    methods = list(dict.fromkeys(shot.method for shot in shots))
    counts = sorted({shot.shots for shot in shots})
    table = {
        (method, count): [s for s in shots if (s.method, s.shots) == (method, count)]
        for method in methods
        for count in counts
    }
    drawings = [_curves(title, methods, counts, table, metric) for metric in ("eps8", "male")]
    drawings.append(_race(title, table))
    with_off = all(shot.off_eps8 is not None for shot in shots)
    lines = tuple(
        Line((f"{method}, {count}", *_cells(table[method, count], with_off)), best=False)
        for method in methods
        for count in counts
    )
    head = (
        "method, shots", "eps8", "male", *(("eps8 off grid", "male off grid") if with_off else ()),
        "seconds", "numbers kept", "compression of the grid",
    )  # fmt: skip
    return Section(title, tuple(drawings), (Grid("error and time", head, lines),))


def _cells(group: Sequence[Shot], with_off: bool) -> tuple[str, ...]:
    numbers = mean(s.numbers for s in group)
    off = (
        f"{mean(s.off_eps8 or 0.0 for s in group):.2f}",
        f"{mean(s.off_male or 0.0 for s in group):.3f}",
    )
    return (
        f"{mean(s.eps8 for s in group):.2f}",
        f"{mean(s.male for s in group):.3f}",
        *(off if with_off else ()),
        f"{mean(s.seconds for s in group):.2f}",
        f"{numbers:.0f}",
        f"{_PAIRS * mean(s.channels for s in group) / numbers:.1f}",
    )


def _curves(
    title: str,
    methods: Sequence[str],
    counts: Sequence[int],
    table: dict[tuple[str, int], list[Shot]],
    metric: str,
) -> Drawing:
    name = f"{metric} against the number of shots"
    with page_style():
        figure = _draw(methods, counts, table, metric)
        svg = inline_svg(figure, f"{identifier(title)}-{metric}-shots", name)
    return Drawing(name, svg, "A line a method, on logarithmic axes.")


def _draw(
    methods: Sequence[str],
    counts: Sequence[int],
    table: dict[tuple[str, int], list[Shot]],
    metric: str,
) -> Figure:
    figure = new_figure(5.4, 4.0)
    axes = figure.subplots()
    for method, (color, mark) in zip(methods, SERIES, strict=False):
        errors = [mean(getattr(s, metric) for s in table[method, count]) for count in counts]
        axes.plot(counts, errors, color=color, marker=mark, markersize=4, label=method)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xticks(counts, [str(count) for count in counts], fontsize=7)
    axes.minorticks_off()
    label_decades(axes.yaxis)
    axes.grid(axis="y", linewidth=0.6)
    axes.set_xlabel("shots")
    axes.set_ylabel("eps8 (8-bit steps)" if metric == "eps8" else metric)
    axes.legend(fontsize=7, loc="upper right")
    return figure


def _race(title: str, table: dict[tuple[str, int], list[Shot]]) -> Drawing:
    points = [
        Point(f"{method} {count}", mean(s.seconds for s in group), mean(s.eps8 for s in group))
        for (method, count), group in table.items()
    ]
    name = "eps8 against the time of the reconstruction"
    with page_style():
        figure = draw_pareto(points, "eps8 (8-bit steps)", "seconds", size_in=(7.5, 5.5))
        svg = inline_svg(figure, f"{identifier(title)}-race", name)
    return Drawing(name, svg, "Each point is a method with its number of shots.")
