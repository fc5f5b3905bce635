"""`gonio study targets`: what the paper leaves unsaid, and what it does to the ranking."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers
from gonio.cli._study import names_in, study_options
from gonio.cli._study_end import show_end, show_grids, write_trainings

if TYPE_CHECKING:
    from gonio.cli._study import Setting
    from nnbrdf.studies.job import Job, Outcome
    from nnbrdf.studies.settings import Ranked

TITLE = "Steps, targets and white"
ABOUT = (
    "The paper says neither how many steps a subset gets nor on which scale targets lie. Cells "
    "are eps8: the mean over the subsets of the median over the seeds, network 15-30-20. Kendall's "
    "tau is 1 where a setting ranks activations as the recipe does, -1 where it turns them over; "
    "between the even and the odd seeds of one setting it says how much of that is chance. Equal "
    "steps are left out where all subsets have as many anyway."
)


@click.command(name="targets")
@study_options
@click.option("--activations", help="Names, with commas between.  [default: all twenty]")
@answers
def command(setting: Setting, *, activations: str | None) -> None:
    """Compare equal epochs and equal steps, targets to 1 and to 255, and other whites.

    Each setting trains every activation on MATERIALS anew, and ranks them.

    \b
    Examples:
        gonio study targets wood-veneer --activations softsign,tanh,gelu,relu
        gonio study targets felt.npz silk.npz --subsets va-ia,vs-is --seeds 3
    """  # noqa: D301
    from gonio.report.settings import settings_section
    from gonio.report.study import summary_section, write_study
    from nnbrdf.activations import ACTIVATIONS
    from nnbrdf.studies import designs
    from nnbrdf.studies.export import write_agreements, write_settings

    names = names_in(activations, list(ACTIVATIONS), "activation")
    designed = {
        name: designs.targets(truth, setting.extent, names)
        for name, truth in setting.truths.items()
    }
    every = (job for by_name in designed.values() for jobs in by_name.values() for job in jobs)
    outcomes = {outcome.job.key: outcome for outcome in setting.outcomes(list(every))}
    ranked = {name: _rank(by_name, outcomes) for name, by_name in designed.items()}
    sections = [settings_section(name, settings) for name, settings in ranked.items()]
    if len(ranked) > 1:
        errors = {
            name: [settings[name].errors for settings in ranked.values()]
            for name in next(iter(ranked.values()))
        }
        sections.append(summary_section(errors))
    write_trainings(setting, "targets", list(outcomes.values()))
    write_settings(setting.folder / "targets-eps8.csv", ranked)
    write_agreements(setting.folder / "targets-tau.csv", ranked)
    page = setting.folder / "targets.html"
    write_study(page, TITLE, ABOUT, sections, setting.notes)
    for section in sections:
        show_grids(section.title, section.grids)
    show_end(page, list(outcomes.values()))
    eps8 = {
        name: {setting_name: asdict(one.errors) for setting_name, one in settings.items()}
        for name, settings in ranked.items()
    }
    answer({"page": page, "eps8": eps8, "trainings": [one.row() for one in outcomes.values()]})


def _rank(designed: dict[str, list[Job]], outcomes: dict[str, Outcome]) -> dict[str, Ranked]:
    from nnbrdf.studies.settings import rank_setting

    return {
        name: rank_setting([outcomes[job.key] for job in jobs], lambda job: job.activation)
        for name, jobs in designed.items()
    }
