"""`gonio study activations`: the paper's tables 2 and 3."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from gonio.cli._study import (
    conclude,
    names_in,
    networks_in,
    read_setting,
    study_options,
)

if TYPE_CHECKING:
    from pathlib import Path

TITLE = "Activations"
ABOUT = (
    "Every activation on the same pairs, with the recipe of Mikes and Haindl (2023). Cells are "
    "medians over the seeds; ranks go by the mean of the cells."
)


@click.command(name="activations")
@study_options
@click.option("--activations", help="Names, with commas between.  [default: all twenty]")
@click.option("--networks", default="15-30-20,3-6-4", show_default=True, help="Hidden layers.")
def command(
    *,
    materials: tuple[str, ...],
    output: Path,
    subsets: str,
    seeds: int,
    epochs: int,
    steps: int | None,
    activations: str | None,
    networks: str,
) -> None:
    """Compare activations on MATERIALS: errors, learning times, ranks.

    \b
    Examples:
        gonio study activations wood-veneer
        gonio study activations felt.npz silk.npz --activations softsign,tanh,gelu
    """  # noqa: D301
    from nnbrdf.activations import ACTIVATIONS
    from nnbrdf.studies import designs

    names = names_in(activations, list(ACTIVATIONS), "activation")
    shapes = networks_in(networks)

    setting = read_setting(materials, output, subsets, seeds=seeds, epochs=epochs, steps=steps)
    jobs = [
        job
        for truth in setting.truths.values()
        for job in designs.activations(truth, setting.extent, names, shapes)
    ]
    outcomes = setting.outcomes(jobs)
    conclude(output / "activations.html", TITLE, ABOUT, outcomes, lambda job: job.activation)
