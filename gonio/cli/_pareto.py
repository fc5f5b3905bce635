"""`gonio plan --pareto`: many plans side by side, as picture and table."""

from __future__ import annotations

import csv
import io
from functools import partial
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from gonio.cli._json import answer

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from gonio.report.sweep import Compared
    from gonio.rig import Rig

_HEAD = (
    "criterion", "side", "pairs", "shots", "acquisition_s", "expected_error", "planning_s",
    "on_front", "knee",
)  # fmt: skip
ABOUT = (
    "The expected error is the standard deviation of ln(BRDF) that is left under the prior once a "
    "design's pairs are measured, root mean square over all pairs of candidates, isotropic "
    "materials counting four fifths. It is told before anything of the material is known: a "
    "material like few of the prior errs more."
)
KNEE = (
    "the point of the front farthest below the line from its first to its last, time and the "
    "logarithm of the error each from 0 to 1 (Kneedle, Satopaa et al. 2011): a minute is a minute "
    "anywhere, an error counts by its ratio; it depends on the longest time that was tried"
)


def write_pareto(
    folder: Path, criterion: str | None, rig: Rig, settings: Mapping[str, Any]
) -> None:
    """Try every design, write `pareto.html` and `pareto.csv` into `folder`, say what one learns.

    Parameters
    ----------
    criterion
        By name; None: all.
    settings
        What `planner.make.make_plan` is called with beside a design's own.
    """
    from gonio.cli._console import console, progress_bar
    from gonio.cli._study_end import show_grids
    from gonio.report.study import write_study
    from gonio.report.sweep import Compared
    from nnbrdf.cores import cores
    from planner.beliefs import RememberedPrior
    from planner.criteria import CRITERIA
    from planner.expected import ExpectedError, rank_for
    from planner.field import Field
    from planner.make import make_plan
    from planner.sweep import designs_of, run_sweep

    lights, views = settings["light_candidates"], settings["view_candidates"]
    demand = settings["demand"] and settings["demand"](lights, views)
    field = Field(lights, views, np.ones((len(lights), len(views)), bool), demand)
    designs = designs_of([criterion] if criterion else CRITERIA, field)
    known = RememberedPrior(settings["prior"], rank_for(field))
    plan_of = partial(make_plan, rig, **{**settings, "prior": lambda: known})
    with progress_bar("planning") as progress:
        judge = ExpectedError(field, known)
        sweep = run_sweep(designs, plan_of, field, judge, progress, workers=cores())
    compared = Compared(sweep)
    table, page = folder / "pareto.csv", folder / "pareto.html"
    _write_table(table, compared)
    notes = [("knee", KNEE)] + [(f"no {d.label} by {d.criterion}", why) for d, why in sweep.refused]
    write_study(
        page,
        "Error against time",
        ABOUT,
        [compared.section()],
        notes,
        eyebrow="gonio plan --pareto",
    )
    show_grids("pareto", [compared.front_grid(), compared.nights_grid()])
    for design, why in sweep.refused:
        click.echo(f"no {design.label} by {design.criterion}: {why}")
    click.echo(compared.learned())
    console.print(f"table: {table}\npage:  {page}")
    designs_found = [dict(zip(_HEAD, row, strict=True)) for row in _rows(compared)]
    answer({"table": table, "page": page, "designs": designs_found, "notes": dict(notes)})


def _rows(compared: Compared) -> Iterator[tuple[Any, ...]]:
    for each in compared.sweep.outcomes:
        yield (
            each.design.criterion, each.design.side, each.design.pairs, each.shots, each.seconds,
            each.error, each.planning_s, each in compared.front, each is compared.knee,
        )  # fmt: skip


def _write_table(path: Path, compared: Compared) -> None:
    from gonio.files import write_bytes

    rows = [
        (
            criterion, side or "", pairs or "", shots, f"{seconds:.1f}", f"{error:.6f}",
            f"{planning_s:.3f}", int(on_front), int(knee),
        )
        for criterion, side, pairs, shots, seconds, error, planning_s, on_front, knee
        in _rows(compared)
    ]  # fmt: skip
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerows([_HEAD, *rows])
    write_bytes(path, buffer.getvalue().encode())
