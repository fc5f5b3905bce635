"""`gonio study topology`: how large a network should be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from gonio.cli._study import (
    conclude,
    networks_in,
    read_setting,
    study_options,
)

if TYPE_CHECKING:
    from pathlib import Path

TITLE = "Topology"
ABOUT = (
    "Networks of many shapes on the same pairs, SoftSign on unit vectors; their weights in "
    "brackets. Cells are medians over the seeds; ranks go by the mean of the cells."
)


@click.command(name="topology")
@study_options
@click.option("--networks", help="Hidden layers, 16-16,32-32-32.  [default: fourteen shapes]")
def command(
    *,
    materials: tuple[str, ...],
    output: Path,
    subsets: str,
    seeds: int,
    epochs: int,
    steps: int | None,
    networks: str | None,
) -> None:
    """Compare shapes of the network on MATERIALS: error against training time.

    \b
    Examples:
        gonio study topology wood-veneer
        gonio study topology felt.npz --networks 16-16,32-32,64-64 --subsets va-ia,vs-is
    """  # noqa: D301
    from nnbrdf.studies import designs

    shapes = networks_in(networks) if networks else designs.TOPOLOGIES

    setting = read_setting(materials, output, subsets, seeds=seeds, epochs=epochs, steps=steps)
    jobs = [
        job
        for truth in setting.truths.values()
        for job in designs.topology(truth, setting.extent, shapes)
    ]
    outcomes = setting.outcomes(jobs)
    conclude(
        output / "topology.html",
        TITLE,
        ABOUT,
        outcomes,
        row_of=lambda job: f"{job.network} ({job.weights})",
        column_of=lambda job: job.subset,
    )
