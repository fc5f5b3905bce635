"""`gonio study analytic`: the literature's models beside the networks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from gonio.cli._study import names_in, show_grids, study_options

if TYPE_CHECKING:
    from gonio.cli._study import Setting
    from nnbrdf.studies.analytic import Result

TITLE = "Analytic models and networks"
ABOUT = (
    "Each model is fitted to the same pairs as the networks: robust least squares of logarithms, "
    "from eight starts. A network is the delivered one of the recipe's; its time is one "
    "network's. Evaluation is by NumPy, on one core."
)


@click.command(name="analytic")
@study_options
@click.option("--models", help="Names, with commas between.  [default: all sixteen]")
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
    from nnbrdf.studies.export import write_results

    names = names_in(models, list(MODELS), "model")
    results = _results(setting, names)
    sections = [analytic_section(name, results[name]) for name in setting.truths]
    setting.folder.mkdir(parents=True, exist_ok=True)
    table = setting.folder / "analytic.csv"
    write_results(table, results)
    page = setting.folder / "analytic.html"
    write_study(page, TITLE, ABOUT, sections)
    for section in sections:
        show_grids(section.title, section.grids)
    console.print(f"table: {table}")
    console.print(f"page:  {page}")


def _results(setting: Setting, names: tuple[str, ...]) -> dict[str, list[Result]]:
    from gonio.cli._console import progress_bar
    from nnbrdf.estimators import PaperEstimator
    from nnbrdf.studies.analytic import compare_model, compare_network
    from nnbrdf.studies.designs import PAPER_NETWORKS

    results: dict[str, list[Result]] = {name: [] for name in setting.truths}
    cases = [
        (truth, *each) for truth in setting.truths.values() for each in setting.subsets.items()
    ]
    total, done = len(cases) * (len(names) + len(PAPER_NETWORKS)), 0
    with progress_bar("fitting") as progress:
        for truth, subset, pairs in cases:
            steps = setting.extent.steps_on(subset)
            for name in names:
                results[truth.name].append(compare_model(name, truth, subset, pairs))
                progress(done := done + 1, total)
            for hidden in PAPER_NETWORKS:
                # an estimator has two members at the least
                members = max(2, setting.extent.seeds)
                recipe = PaperEstimator(hidden=hidden, steps=steps, members=members)
                found = compare_network(recipe, truth, subset, pairs)
                results[truth.name].append(found)
                progress(done := done + 1, total)
    return results
