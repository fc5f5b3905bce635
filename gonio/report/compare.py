"""Every estimator side by side: error against time, and the table."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from gonio.report.drawings import Drawing
from gonio.report.figures import inline_svg, page_style
from gonio.report.pareto import Point, draw_pareto
from nnbrdf.compared import DEFAULT, GENERAL, load_entries

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from nnbrdf.compared import Entry

_HELD_AGAINST = {
    "truth": "Each fitted with its default settings to all samples. Errors against the truth, over "
    "the 81 x 81 pairs.",
    "held out": "Each fitted with its default settings to four of five samples. Errors at every "
    "fifth, which was held out, with white 4 x the median of all.",
}
_TIMES = (
    ("Error against fitting time", "fit_seconds", "time of the fit (s, by the clock)"),
    ("Error against evaluation time", "million_seconds", "time of a million pairs (s, one core)"),
)
_CLOCKS = (
    "Of a fit, the time is that of the clock on the wall, on all cores; other work adds to it. "
    "Of a million pairs, it is the processor's, on one core."
)
_SIZE_IN = (4.2, 3.4)


class Comparison(NamedTuple):
    """What the page shows of a comparison.

    Attributes
    ----------
    entries
        Least eps8 first.
    held_against
        What the errors are, in a sentence.
    clocks
        What the times are, in two sentences.
    left_out
        What leaving out saved and cost, in a sentence; empty where it was not compared.
    drawings
        Error against time of fitting, and of evaluation.
    """

    entries: list[Entry]
    held_against: str
    clocks: str
    left_out: str
    drawings: list[Drawing]


def comparison_of(model: Path) -> Comparison | None:
    """Return what a model's folder holds of a comparison, if there is one.

    Raises
    ------
    gonio.errors.BadFileError
        When its table is broken.
    """
    entries = sorted(load_entries(model), key=lambda entry: entry.eps8)
    if not entries:
        return None
    drawings = [_race(entries, *each) for each in _TIMES]
    held_against = _HELD_AGAINST[entries[0].against]
    return Comparison(entries, held_against, _CLOCKS, left_out_of(entries), drawings)


def left_out_of(entries: Sequence[Entry]) -> str:
    """Say what it saves, and costs, to leave out what the samples show the material not to need."""
    by_name = {entry.name: entry for entry in entries}
    if not {DEFAULT, GENERAL} <= by_name.keys():
        return ""
    some, all_ = by_name[DEFAULT], by_name[GENERAL]
    return (
        f"Without what its samples show this material not to need, weights are {some.weights} "
        f"instead of {all_.weights}, the fit takes {some.fit_seconds:.1f} s instead of "
        f"{all_.fit_seconds:.1f} s and a million pairs {1000 * some.million_seconds:.0f} ms "
        f"instead of {1000 * all_.million_seconds:.0f} ms; eps8 / male are {some.eps8:.2f} / "
        f"{some.male:.3f} instead of {all_.eps8:.2f} / {all_.male:.3f}."
    )


def _race(entries: Sequence[Entry], title: str, field: str, time_name: str) -> Drawing:
    points = [Point(entry.name, getattr(entry, field), entry.eps8) for entry in entries]
    with page_style():
        figure = draw_pareto(points, "eps8 (8-bit steps)", time_name, _SIZE_IN)
        svg = inline_svg(figure, "-".join(title.lower().split()), title)
    return Drawing(title, svg, "Nobody beats those on the line in both at once.")
