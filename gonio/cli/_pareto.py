"""`gonio plan --pareto`: many plans side by side, as picture and table."""

from __future__ import annotations

import csv
import io
from functools import partial
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from planner.field import Field

    from gonio.plan import Plan
    from gonio.protocols import Prior
    from gonio.report.sweep import Compared

ABOUT = (
    "The expected error is the standard deviation of ln(BRDF) that is left under the prior once a "
    "design's pairs are measured, root mean square over all pairs of candidates, isotropic "
    "materials counting four fifths. It is told before anything of the material is known: a "
    "material like few of the prior errs more."
)
KNEE = (
    "the point of the front farthest below the line from its first to its last, both axes "
    "logarithmic and of length one (Kneedle, Satopaa et al. 2011); it depends on what was tried"
)


def write_pareto(
    folder: Path,
    criteria: Sequence[str],
    plan_of: Callable[..., Plan],
    field: Field,
    prior: Prior,
) -> None:
    """Try every design, write `pareto.html` and `pareto.csv` into `folder`, say what one learns.

    Parameters
    ----------
    criteria
        By name.
    plan_of
        `planner.make.make_plan` with everything but a design's settings and the prior.
    field
        The candidates that the plans choose from.
    """
    from gonio.cli._console import console, progress_bar
    from gonio.cli._study_end import show_grids
    from gonio.report.study import write_study
    from gonio.report.sweep import Compared
    from planner.expected import ExpectedError, RememberedPrior, rank_for
    from planner.sweep import designs_of, run_sweep

    known = RememberedPrior(prior, rank_for(field))
    judge = ExpectedError(field, known)
    with progress_bar("planning") as progress:
        sweep = run_sweep(
            designs_of(criteria), partial(plan_of, prior=lambda: known), field, judge, progress
        )
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


def _write_table(path: Path, compared: Compared) -> None:
    from gonio.files import write_bytes

    head = (
        "criterion", "side", "pairs", "shots", "acquisition_s", "expected_error", "planning_s",
        "on_front", "knee",
    )  # fmt: skip
    rows: list[tuple[Any, ...]] = [
        (
            each.design.criterion, each.design.side or "", each.design.pairs or "", each.shots,
            f"{each.seconds:.1f}", f"{each.error:.6f}", f"{each.planning_s:.3f}",
            int(each in compared.front), int(each is compared.knee),
        )
        for each in compared.sweep.outcomes
    ]  # fmt: skip
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerows([head, *rows])
    write_bytes(path, buffer.getvalue().encode())
