"""The page of a study: error against time, and the tables."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gonio.files import write_bytes
from gonio.report.drawings import Drawing
from gonio.report.figures import inline_svg, page_style
from gonio.report.grids import DIGITS, NAMES, Grid, Line, Section, identifier, number
from gonio.report.pareto import Point, draw_pareto
from nnbrdf.studies.tables import BIGGER_IS_BETTER, mean_ranks

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from nnbrdf.studies.analytic import Result
    from nnbrdf.studies.tables import Row, Table


def grid_of(table: Table) -> Grid:
    """Return a table of a study in words, best first."""
    digits = DIGITS[table.metric]
    distance = "below best" if table.metric in BIGGER_IS_BETTER else "above best"
    head = ("", *table.columns, "mean", "rank", distance, "diverged")
    lines = tuple(_line(row, digits) for row in sorted(table.rows, key=lambda row: row.rank))
    return Grid(f"{NAMES[table.metric]}: median over the seeds", head, lines)


def section_of(tables: Sequence[Table]) -> Section:
    """Return what the page says of one material.

    Parameters
    ----------
    tables
        One a metric, of the same rows; `seconds` and at least one other among them.
    """
    times = next(table for table in tables if table.metric == "seconds")
    drawings = [_pareto(table, times) for table in tables if table.metric in ("eps8", "male")]
    return Section(
        times.material,
        tuple(drawing for drawing in drawings if drawing is not None),
        tuple(grid_of(table) for table in tables),
    )


def analytic_section(material: str, results: Sequence[Result]) -> Section:
    """Return analytic models and networks of one material: a table and two pictures a subset."""
    drawings, grids = [], []
    for subset in dict.fromkeys(one.subset for one in results):
        group = sorted(
            (one for one in results if one.subset == subset), key=lambda one: one.scores.male
        )
        name = f"{identifier(material)}-{subset}"
        drawings += [
            _race(group, f"{name}-fit", "time of the fit (s)", "fit_seconds"),
            _race(group, f"{name}-million", "time of a million pairs (s)", "million_seconds"),
        ]
        grids.append(_race_grid(subset, group))
    return Section(material, tuple(drawings), tuple(grids))


def summary_section(columns: Mapping[str, Sequence[Table]]) -> Section:
    """Return the mean rank of each row over several materials.

    Parameters
    ----------
    columns
        Tables by the name of their column, one a material, all of the same rows; lines go by
        the first.
    """
    ranks = {name: mean_ranks(tables) for name, tables in columns.items()}
    first, *_ = ranks.values()
    rows = sorted(first, key=lambda row: first[row])
    lines = tuple(
        Line((row, *(f"{each[row]:.1f}" for each in ranks.values())), best=row == rows[0])
        for row in rows
    )
    materials = len(next(iter(columns.values())))
    grid = Grid(f"mean rank over {materials} materials", ("", *columns), lines)
    return Section("All materials", (), (grid,))


def write_study(
    target: Path,
    title: str,
    about: str,
    sections: Sequence[Section],
    notes: Sequence[tuple[str, str]],
    eyebrow: str = "gonio study",
) -> None:
    """Write the page, whole or not at all.

    Parameters
    ----------
    target
        Where to.
    title, about
        What the study is, in a word and in a paragraph.
    sections
        What it found.
    notes
        How it was made, each with its name; command, date and machine come by themselves.
    eyebrow
        Which command it is of.

    Raises
    ------
    gonio.errors.StorageError
        When it cannot be written.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from gonio.report.machine import made_by
    from gonio.report.provenance import versions

    environment = Environment(
        loader=PackageLoader("gonio", "report"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    content = {
        "eyebrow": eyebrow, "title": title, "about": about, "sections": sections,
        "notes": [*notes, *made_by()], "versions": versions(),
    }  # fmt: skip
    page = environment.get_template("study.html").render(content)
    write_bytes(target, page.encode("utf-8", "backslashreplace"))


def _race(results: Sequence[Result], name: str, time_name: str, field: str) -> Drawing:
    points = [
        Point(one.name, seconds, one.scores.male)
        for one in results
        # networks that diverged have neither
        if math.isfinite(seconds := getattr(one, field)) and math.isfinite(one.scores.male)
    ]
    title = f"{results[0].subset}: male against the {time_name}"
    with page_style():
        svg = inline_svg(draw_pareto(points, "male", time_name), name, title)
    return Drawing(title, svg, "Nobody beats those on the line in both at once.")


def _race_grid(subset: str, results: Sequence[Result]) -> Grid:
    head = (
        "",
        "parameters",
        "eps8",
        "male",
        "cube-root RMSE",
        "sphere PSNR",
        "time of the fit (s)",
        "time of 1,000,000 pairs (s)",
    )
    lines = tuple(
        Line(
            (
                one.name,
                str(one.numbers),
                # times have as many digits as one another
                *(
                    number(cell, DIGITS.get(name, DIGITS["seconds"]))
                    for name, cell in one.cells().items()
                ),
            ),
            best=one is results[0] and math.isfinite(one.scores.male),
        )
        for one in results
    )
    return Grid(f"{subset}, best male first", head, lines)


def _line(row: Row, digits: int) -> Line:
    cells = (
        row.name,
        *(number(value, digits) for value in (*row.cells, row.mean)),
        "" if row.mean is None else str(row.rank),
        "" if row.percent_from_best is None else f"{row.percent_from_best:.1f} %",
        str(row.diverged),
    )
    return Line(cells, best=row.rank == 1 and row.mean is not None)


def _pareto(table: Table, times: Table) -> Drawing | None:
    seconds = {row.name: row.mean for row in times.rows}
    points = [
        Point(row.name, time, row.mean)
        for row in table.rows
        if row.mean is not None and (time := seconds[row.name]) is not None
    ]
    if not points:
        return None
    name = NAMES[table.metric]
    with page_style():
        figure = draw_pareto(points, f"{name}, mean of the columns", "training time (s)")
        title = f"{table.metric} against training time"
        svg = inline_svg(figure, f"{identifier(table.material)}-{table.metric}", title)
    caption = (
        "Each point is a row of the tables below. Nobody beats those on the line in both at once."
    )
    return Drawing(title, svg, caption)
