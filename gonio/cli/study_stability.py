"""`gonio study stability`: stiff and extreme trainings, measured."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click
import numpy as np

from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from gonio.protocols import Progress
    from gonio.report.grids import Section

    Data = tuple[NDArray[np.float64], NDArray[np.float64]]

T = TypeVar("T")

TITLE = "Stability"
ABOUT = (
    "Extreme samples, first steps, precision, and step sizes about the limit, on the 14 x 14 pairs "
    "of one material."
)
RATES = (1e-4, 3e-4, 1e-3, 2.5e-3, 6e-3, 1.5e-2, 4e-2, 0.1, 0.3)
SHARES = (0.9, 0.99, 1.01, 1.1)
STEPS = 3500
DRIFTING = ("softsign", "relu")
PARTS = ("cases", "starts", "limits")


@click.command(name="stability")
@click.argument("material", default="wood-veneer")
@click.option("-o", "--output", type=click.Path(path_type=Path), default=Path("study"),
              show_default=True, help="Folder of the page.")  # fmt: skip
@answers
def command(*, material: str, output: Path) -> None:
    """Show where training is stiff or extreme on MATERIAL, and what becomes of it.

    \b
    Examples:
        gonio study stability
        gonio study stability felt.npz -o stability/
    """  # noqa: D301
    from importlib.util import find_spec

    from gonio.cli._console import console, progress_bar
    from gonio.cli._study import read_setting
    from gonio.cli._study_end import grids_document, show_grids, write_grid
    from gonio.errors import MissingExtraError
    from gonio.report.study import write_study
    from nnbrdf.studies.analytic import samples_of

    if find_spec("torch") is None:
        raise MissingExtraError("torch", "nn")
    setting = read_setting([material], output, "vs-is", seeds=1, epochs=1, steps=None)
    (truth,), (pairs,) = setting.truths.values(), setting.subsets.values()
    samples = samples_of(truth, pairs)
    inputs = np.concatenate([samples.view, samples.light], axis=1)
    data = inputs, np.clip(samples.value / truth.white, 0.0, 1.0)
    try:
        with progress_bar("measuring") as progress:
            section = _section(truth.name, data, progress)
    except KeyboardInterrupt as stop:
        stop.args = ("nothing is kept, and the same command begins anew",)
        raise
    output.mkdir(parents=True, exist_ok=True)
    for part, grid in zip(PARTS, section.grids, strict=True):
        write_grid(output / f"stability-{part}.csv", grid)
    page = output / "stability.html"
    write_study(page, TITLE, ABOUT, [section], [])
    show_grids(section.title, section.grids)
    console.print(f"tables: {output}/stability-*.csv")
    console.print(f"page:   {page}")
    answer({"page": page, "tables": grids_document(section.grids)})


def _section(name: str, data: Data, progress: Progress) -> Section:
    from gonio.report import stability as page
    from gonio.report.grids import Section
    from nnbrdf.activations import ACTIVATIONS
    from nnbrdf.stability.cases import CASES, outcome
    from nnbrdf.stability.floor import loss_floor
    from nnbrdf.stability.precision import drift
    from nnbrdf.stability.starts import look_at_start

    lengths = (STEPS, 10 * STEPS)
    total = len(ACTIVATIONS) + len(CASES) + len(DRIFTING) + len(lengths) * len(RATES) + 1
    done = iter(range(1, total + 1))

    def each_of(names: Iterable[T]) -> Iterator[T]:
        for name in names:
            yield name
            progress(next(done), total)

    progress(0, total)
    cases = {case: {each: outcome(each, case) for each in ACTIVATIONS} for case in each_of(CASES)}
    starts = {
        each: look_at_start(each, *data, (15, 30, 20), STEPS) for each in each_of(ACTIVATIONS)
    }
    drifts = {each: drift(each, *data, 4 * STEPS) for each in each_of(DRIFTING)}
    floors = {
        steps: [loss_floor(*data, rate, steps) for rate in each_of(RATES)] for steps in lengths
    }
    (limits,) = [_limits(data) for _ in each_of(["limits"])]
    return Section(
        name,
        (page.draw_drift(drifts), page.draw_floor(RATES, floors)),
        (page.cases_grid(cases), page.starts_grid(starts), page.limits_grid(limits)),
    )


def _limits(data: Data) -> list[tuple[str, float, float, float]]:
    """Return the growth of an error about the limits of both methods, network 3-6-4."""
    from nnbrdf.stability import limits

    loss, start = limits.squared_loss(*data, (3, 6, 4))
    descended = limits.descend(loss, start, 0.5, 1000)
    curvature, _ = limits.largest_curvature(loss, descended)
    settled, scale = limits.adamax(loss, start, 2.5e-3, 1000)
    preconditioned, _ = limits.largest_curvature(loss, settled, scale)
    rows = []
    for share in SHARES:
        rate = share * limits.DESCENT_LIMIT / curvature
        growth = limits.descent_growth(loss, descended, rate)
        rows.append(("gradient descent", share, rate, growth))
    for share in SHARES:
        rate = share * limits.ADAMAX_LIMIT / preconditioned
        growth = limits.momentum_growth(loss, settled, scale, rate)
        rows.append(("Adamax, its norm held", share, rate, growth))
    return rows
