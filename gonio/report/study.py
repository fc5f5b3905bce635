"""The page of a study: error against time, and the tables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.files import write_bytes
from gonio.report.drawings import Drawing
from gonio.report.figures import inline_svg, page_style
from gonio.report.pareto import Point, draw_pareto
from nnbrdf.studies.tables import kendall_tau, ranking

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from nnbrdf.studies.analytic import Result
    from nnbrdf.studies.tables import Row, Table

NAMES = {
    "eps8": "eps8 (8-bit steps)",
    "male": "male",
    "cube_root_rmse": "cube-root RMSE",
    "sphere_psnr_db": "sphere PSNR (dB)",
    "seconds": "learning time (s, one core)",
}
_DIGITS = {"eps8": 2, "male": 3, "cube_root_rmse": 4, "sphere_psnr_db": 1, "seconds": 3}


@dataclass(frozen=True)
class Line:
    """One row of a grid: its name first."""

    cells: tuple[str, ...]
    best: bool


@dataclass(frozen=True)
class Grid:
    """A table, ready for a page or a terminal."""

    title: str
    head: tuple[str, ...]
    lines: tuple[Line, ...]


@dataclass(frozen=True)
class Section:
    """One material."""

    title: str
    drawings: tuple[Drawing, ...]
    grids: tuple[Grid, ...]


def grid_of(table: Table) -> Grid:
    """Return a table of a study in words, best first."""
    digits = _DIGITS[table.metric]
    head = ("", *table.columns, "mean", "rank", "above best", "diverged")
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


def settings_section(material: str, tables: Mapping[str, Table]) -> Section:
    """Return what settings do to a ranking: means side by side, and how the orders agree.

    Parameters
    ----------
    tables
        One a setting, of the same rows and metric; the first is what the others are held against.
    """
    recipe, *_ = tables.values()
    digits = _DIGITS[recipe.metric]
    means = {
        row.name: [_mean_of(table, row.name) for table in tables.values()] for row in recipe.rows
    }
    side_by_side = Grid(
        f"{NAMES[recipe.metric]}: mean of the subsets",
        ("", *tables),
        tuple(
            Line((name, *(_number(mean, digits) for mean in means[name])), best=name == best)
            for best in ranking(recipe)[:1]
            for name in ranking(recipe)
        ),
    )
    orders = Grid(
        "What it does to the ranking",
        ("setting", "Kendall's tau", "best", "second", "third", "rank of softsign"),
        tuple(_order_line(name, recipe, table) for name, table in tables.items()),
    )
    return Section(material, (), (side_by_side, orders))


def analytic_section(material: str, results: Sequence[Result]) -> Section:
    """Return analytic models and networks of one material: a table and two pictures a subset."""
    drawings, grids = [], []
    for subset in dict.fromkeys(one.subset for one in results):
        group = sorted(
            (one for one in results if one.subset == subset), key=lambda one: one.scores.male
        )
        name = f"{_identifier(material)}-{subset}"
        drawings += [
            _race(group, f"{name}-fit", "time of the fit (s)", "fit_seconds"),
            _race(group, f"{name}-million", "time of a million pairs (s)", "million_seconds"),
        ]
        grids.append(_race_grid(subset, group))
    return Section(material, tuple(drawings), tuple(grids))


def write_study(target: Path, title: str, about: str, sections: Sequence[Section]) -> None:
    """Write the page, whole or not at all.

    Raises
    ------
    gonio.errors.StorageError
        When it cannot be written.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from gonio.report.provenance import versions

    environment = Environment(
        loader=PackageLoader("gonio", "report"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    content = {"title": title, "about": about, "sections": sections, "versions": versions()}
    page = environment.get_template("study.html").render(content)
    write_bytes(target, page.encode("utf-8", "backslashreplace"))


def _race(results: Sequence[Result], name: str, time_name: str, field: str) -> Drawing:
    points = [Point(one.name, getattr(one, field), one.scores.male) for one in results]
    title = f"{results[0].subset}: male against the {time_name}"
    with page_style():
        svg = inline_svg(draw_pareto(points, "male", time_name), name, title)
    return Drawing(title, svg, "Nobody beats those on the line in both at once.")


def _race_grid(subset: str, results: Sequence[Result]) -> Grid:
    head = (
        "",
        "numbers",
        "eps8",
        "male",
        "cube-root RMSE",
        "sphere PSNR",
        "fit (s)",
        "million (s)",
    )
    lines = tuple(
        Line(
            (
                one.name, str(one.numbers), f"{one.scores.eps8:.2f}", f"{one.scores.male:.3f}",
                f"{one.scores.cube_root_rmse:.4f}", f"{one.scores.sphere_psnr_db:.1f}",
                f"{one.fit_seconds:.3f}", f"{one.million_seconds:.3f}",
            ),
            best=one is results[0],
        )
        for one in results
    )  # fmt: skip
    return Grid(f"{subset}, best male first", head, lines)


def _order_line(name: str, recipe: Table, table: Table) -> Line:
    ranks = {row.name: row.rank for row in table.rows}
    first, second, third = [*ranking(table), "", ""][:3]
    tau = kendall_tau([row.rank for row in recipe.rows], [ranks[row.name] for row in recipe.rows])
    agreement = "" if tau is None else f"{tau:.2f}"
    return Line((name, agreement, first, second, third, str(ranks.get("softsign", ""))), best=False)


def _mean_of(table: Table, name: str) -> float | None:
    return next(row.mean for row in table.rows if row.name == name)


def _line(row: Row, digits: int) -> Line:
    cells = (
        row.name,
        *(_number(value, digits) for value in (*row.cells, row.mean)),
        "" if row.mean is None else str(row.rank),
        "" if row.percent_above_best is None else f"{row.percent_above_best:.1f} %",
        str(row.diverged) if row.diverged else "",
    )
    return Line(cells, best=row.rank == 1 and row.mean is not None)


def _number(value: float | None, digits: int) -> str:
    return "diverged" if value is None else f"{value:.{digits}f}"


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
        svg = inline_svg(figure, f"{_identifier(table.material)}-{table.metric}", title)
    caption = (
        "Each point is a row of the tables below. Nobody beats those on the line in both at once."
    )
    return Drawing(title, svg, caption)


def _identifier(name: str) -> str:
    return "".join(letter if letter.isalnum() else "-" for letter in name)
