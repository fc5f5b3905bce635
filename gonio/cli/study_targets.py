"""`gonio study targets`: what the paper leaves unsaid, and what it does to the ranking."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from gonio.cli._study import (
    Setting,
    names_in,
    read_setting,
    show_end,
    show_grids,
    study_options,
)

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.report.study import Section
    from nnbrdf.studies.job import Outcome
    from nnbrdf.studies.train import Truth

TITLE = "Steps, targets and white"
ABOUT = (
    "The paper says neither how many steps a subset gets nor on which scale targets lie. Cells "
    "are eps8: the mean over the subsets of the median over the seeds, network 15-30-20. Kendall's "
    "tau is 1 where a setting ranks activations as the recipe does, -1 where it turns them over."
)


@click.command(name="targets")
@study_options
@click.option("--activations", help="Names, with commas between.  [default: all twenty]")
def command(
    *,
    materials: tuple[str, ...],
    output: Path,
    subsets: str,
    seeds: int,
    epochs: int,
    steps: int | None,
    activations: str | None,
) -> None:
    """Compare equal epochs and equal steps, targets to 1 and to 255, and other whites.

    Each setting trains every activation on MATERIALS anew, and ranks them.

    \b
    Examples:
        gonio study targets wood-veneer --activations softsign,tanh,gelu,relu
        gonio study targets felt.npz silk.npz --subsets va-ia,vs-is --seeds 3
    """  # noqa: D301
    from gonio.report.study import write_study
    from nnbrdf.activations import ACTIVATIONS
    from nnbrdf.studies.export import write_outcomes

    names = names_in(activations, list(ACTIVATIONS), "activation")
    setting = read_setting(materials, output, subsets, seeds=seeds, epochs=epochs, steps=steps)
    sections: list[Section] = []
    every: dict[str, Outcome] = {}
    for truth in setting.truths.values():
        section, outcomes = _section(setting, truth, names)
        sections.append(section)
        every |= {outcome.job.key: outcome for outcome in outcomes}
    write_outcomes(output / "results.csv", list(every.values()))
    page = output / "targets.html"
    write_study(page, TITLE, ABOUT, sections)
    for section in sections:
        show_grids(section.title, section.grids)
    show_end(output, list(every.values()), page)


def _section(
    setting: Setting, truth: Truth, names: tuple[str, ...]
) -> tuple[Section, list[Outcome]]:
    from gonio.report.study import settings_section
    from nnbrdf.studies import designs
    from nnbrdf.studies.tables import tabulate

    designed = designs.targets(truth, setting.extent, names)
    done = setting.outcomes([job for jobs in designed.values() for job in jobs])
    by_key = {outcome.job.key: outcome for outcome in done}
    tables = {
        name: tabulate([by_key[job.key] for job in jobs], "eps8", lambda job: job.activation)[0]
        for name, jobs in designed.items()
    }
    return settings_section(truth.name, tables), done
