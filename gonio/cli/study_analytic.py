"""`gonio study analytic`: the literature's models beside the networks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers
from gonio.cli._study import names_in, study_options
from gonio.cli._study_end import show_grids, write_trainings

if TYPE_CHECKING:
    from gonio.cli._study import Setting
    from nnbrdf.studies.analytic import Result
    from nnbrdf.studies.job import Outcome

TITLE = "Analytic models and networks"
ABOUT = (
    "Each model is fitted to the same pairs as the networks: robust least squares of logarithms, "
    "from eight starts. Of the recipe's networks, errors and times are the medians over the seeds. "
    "Evaluation is by NumPy, on one core."
)


@click.command(name="analytic")
@study_options
@click.option("--models", help="Names, with commas between.  [default: all sixteen]")
@answers
def command(setting: Setting, *, models: str | None) -> None:
    """Compare models of the literature with the networks on MATERIALS.

    Errors stand against the time of the fit and against the time of an evaluation.

    \b
    Examples:
        gonio study analytic brushed-metal --subsets vs-is
        gonio study analytic silk.npz --models ggx,ggx-two-lobes,ward-bounded
    """  # noqa: D301
    from gonio.cli._console import console
    from gonio.report.study import analytic_section, write_study
    from nnbrdf.fitting import MODELS
    from nnbrdf.studies.designs import combinations
    from nnbrdf.studies.export import write_results

    names = names_in(models, list(MODELS), "model")
    outcomes = setting.train(combinations)
    results = _results(setting, names, outcomes)
    sections = [analytic_section(name, results[name]) for name in setting.truths]
    write_trainings(setting, "analytic", outcomes)
    table = setting.folder / "analytic.csv"
    write_results(table, results)
    page = setting.folder / "analytic.html"
    write_study(page, TITLE, ABOUT, sections, setting.notes)
    for section in sections:
        show_grids(section.title, section.grids)
    console.print(f"table: {table}")
    console.print(f"page:  {page}")
    every = [
        {"material": name, "name": one.name, "subset": one.subset, "numbers": one.numbers}
        | one.cells()
        for name, of_material in results.items()
        for one in of_material
    ]
    answer({"page": page, "table": table, "results": every})


def _results(
    setting: Setting, names: tuple[str, ...], outcomes: list[Outcome]
) -> dict[str, list[Result]]:
    from gonio.cli._console import progress_bar
    from nnbrdf.studies.analytic import compare_model, compare_networks

    results: dict[str, list[Result]] = {name: [] for name in setting.truths}
    cases = [
        (truth, *each) for truth in setting.truths.values() for each in setting.subsets.items()
    ]
    total, done = len(cases) * len(names), 0
    with progress_bar("fitting") as progress:
        for truth, subset, pairs in cases:
            for name in names:
                results[truth.name].append(compare_model(name, truth, subset, pairs))
                progress(done := done + 1, total)
            trained = [
                o for o in outcomes if (o.job.material, o.job.subset) == (truth.name, subset)
            ]
            results[truth.name] += compare_networks(trained)
    return results
