"""What the studies share at their end: CSV files, tables on the screen, a page."""

from __future__ import annotations

import csv
import io
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Literal

from gonio.cli._console import console
from gonio.cli._json import answer
from gonio.files import write_bytes
from gonio.words import duration
from nnbrdf.studies.export import write_outcomes, write_table
from nnbrdf.studies.job import METRICS
from nnbrdf.studies.tables import column_of, tabulate

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from gonio.cli._study import Setting
    from gonio.report.grids import Grid
    from nnbrdf.studies.job import Job, Outcome

_WIDEST = 400


def conclude(
    setting: Setting,
    study: str,
    title: str,
    about: str,
    outcomes: Sequence[Outcome],
    row_of: Callable[[Job], str],
    column_of: Callable[[Job], str] = column_of,
) -> None:
    """Write the CSV files of a study beside its page, and the page; print eps8, and the ranks."""
    from gonio.report.study import grid_of, section_of, summary_section, write_study

    tables = {
        metric: tabulate(outcomes, metric, row_of, column_of) for metric in (*METRICS, "seconds")
    }
    sections = [section_of(of_material) for of_material in zip(*tables.values(), strict=True)]
    summary = [summary_section(tables)] if len(sections) > 1 else []
    write_trainings(setting, study, outcomes)
    for metric, of_metric in tables.items():
        write_table(setting.folder / f"{study}-{metric}.csv", of_metric)
    page = setting.folder / f"{study}.html"
    write_study(page, title, about, [*sections, *summary], setting.notes)
    for table in tables["eps8"]:
        show_grids(table.material, [grid_of(table)])
    for section in summary:
        show_grids(section.title, section.grids)
    show_end(page, outcomes)
    every = [asdict(table) for of_metric in tables.values() for table in of_metric]
    answer({"page": page, "tables": every, "trainings": [each.row() for each in outcomes]})


def write_trainings(setting: Setting, study: str, outcomes: Sequence[Outcome]) -> None:
    """Write a line for each training; studies in one folder leave each other's files alone."""
    write_outcomes(setting.folder / f"{study}-trainings.csv", outcomes)


def write_grid(path: Path, grid: Grid) -> None:
    """Write a table that is of words already."""
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerows([grid.head, *(g.cells for g in grid.lines)])
    write_bytes(path, buffer.getvalue().encode())


def show_grids(material: str, grids: Sequence[Grid]) -> None:
    """Print tables of one material."""
    from rich.console import Console
    from rich.measure import Measurement
    from rich.table import Table as Screen

    for grid in grids:
        screen = Screen(title=f"{material}: {grid.title}", box=None, title_justify="left")
        for index, name in enumerate(grid.head):
            justify: Literal["left", "right"] = "right" if index and not grid.words else "left"
            screen.add_column(name.replace(" ", "\n"), justify=justify, no_wrap=True)
        for line in grid.lines:
            screen.add_row(*line.cells, style="bold" if line.best else None)
        # a narrow terminal wraps the lines of a wide table; it must not cut its cells
        roomy = console.options.update(max_width=_WIDEST)
        width = max(console.width, Measurement.get(console, roomy, screen).maximum)
        Console(width=width, highlight=False).print(screen)


def grids_document(grids: Sequence[Grid]) -> list[dict[str, Any]]:
    """Return tables that are of words already, for the answer."""
    return [
        {"title": grid.title, "head": grid.head, "rows": [line.cells for line in grid.lines]}
        for grid in grids
    ]


def show_end(page: Path, outcomes: Sequence[Outcome]) -> None:
    """Say where everything is, and what it took."""
    seconds = sum(outcome.seconds for outcome in outcomes)
    console.print(f"{len(outcomes)} trainings, {duration(seconds)} of one core in all")
    console.print(f"tables: {page.with_name(page.stem)}-*.csv")
    console.print(f"page:   {page}")
