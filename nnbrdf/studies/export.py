"""A study's outcomes and tables as CSV."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

from gonio.files import write_bytes
from nnbrdf.studies.tables import BIGGER_IS_BETTER, means_of, ranking

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from nnbrdf.studies.analytic import Result
    from nnbrdf.studies.job import Outcome
    from nnbrdf.studies.settings import Ranked
    from nnbrdf.studies.tables import Table


def write_outcomes(path: Path, outcomes: Sequence[Outcome]) -> None:
    """Write one line a training.

    Raises
    ------
    gonio.errors.StorageError
        When the operating system refuses.
    """
    rows = [outcome.row() for outcome in outcomes]
    _write(path, [list(rows[0]), *(row.values() for row in rows)])


def write_table(path: Path, tables: Sequence[Table]) -> None:
    """Write the tables of one metric, one line a row of each.

    Raises
    ------
    gonio.errors.StorageError
        When the operating system refuses.
    """
    head = [
        "material",
        "name",
        *tables[0].columns,
        "mean",
        "rank",
        "percent_below_best" if tables[0].metric in BIGGER_IS_BETTER else "percent_above_best",
        "diverged",
    ]
    lines = [
        [table.material, row.name, *row.cells, row.mean, row.rank, row.percent_from_best,
         row.diverged]
        for table in tables
        for row in table.rows
    ]  # fmt: skip
    _write(path, [head, *lines])


def write_settings(path: Path, ranked: Mapping[str, Mapping[str, Ranked]]) -> None:
    """Write the mean error under each setting by material, one line a row, a column a setting.

    Raises
    ------
    gonio.errors.StorageError
        When the operating system refuses.
    """
    head = ["material", "name", *next(iter(ranked.values()))]
    lines = [
        [material, *row]
        for material, settings in ranked.items()
        for row in means_of([each.errors for each in settings.values()])
    ]
    _write(path, [head, *lines])


def write_agreements(path: Path, ranked: Mapping[str, Mapping[str, Ranked]]) -> None:
    """Write what each setting does to the ranking by material, one line a setting.

    Raises
    ------
    gonio.errors.StorageError
        When the operating system refuses.
    """
    head = ["material", "setting", "tau_to_recipe", "tau_between_seeds", "best", "second", "third"]
    lines = [
        [material, name, one.tau_to(recipe), one.tau_between_seeds, *ranking(one.errors)[:3]]
        for material, settings in ranked.items()
        for recipe in [next(iter(settings.values()))]
        for name, one in settings.items()
    ]
    _write(path, [head, *lines])


def write_results(path: Path, results: Mapping[str, Sequence[Result]]) -> None:
    """Write the results of analytic models by material, one line each.

    Raises
    ------
    gonio.errors.StorageError
        When the operating system refuses.
    """
    lines = [
        {"material": material, "name": one.name, "subset": one.subset, "parameters": one.numbers}
        | one.cells()
        for material, group in results.items()
        for one in group
    ]
    _write(path, [list(lines[0]), *(line.values() for line in lines)])


def _write(path: Path, lines: Iterable[Iterable[object]]) -> None:
    buffer = io.StringIO()
    # csv writes None as nothing: a training that diverged has no error
    csv.writer(buffer, lineterminator="\n").writerows(lines)
    write_bytes(path, buffer.getvalue().encode())
