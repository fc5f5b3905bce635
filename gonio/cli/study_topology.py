"""`gonio study topology`: how large a network should be."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answers
from gonio.cli._study import networks_in, study_options
from gonio.cli._study_end import conclude

if TYPE_CHECKING:
    from gonio.cli._study import Setting

TITLE = "Topology"
ABOUT = (
    "Networks of many shapes on the same pairs, SoftSign on unit vectors; their weights in "
    "brackets. Cells are medians over the seeds; ranks go by the mean of the cells."
)


@click.command(name="topology")
@study_options
@click.option("--networks", help="Hidden layers, 16-16,32-32-32.  [default: fourteen shapes]")
@answers
def command(setting: Setting, *, networks: str | None) -> None:
    """Compare shapes of the network on MATERIALS: error against training time.

    \b
    Examples:
        gonio study topology wood-veneer
        gonio study topology felt.npz --networks 16-16,32-32,64-64 --subsets va-ia,vs-is
    """  # noqa: D301
    from nnbrdf.studies.designs import TOPOLOGIES, combinations

    shapes = networks_in(networks) if networks else TOPOLOGIES
    outcomes = setting.train(partial(combinations, networks=shapes))
    conclude(
        setting,
        "topology",
        TITLE,
        ABOUT,
        outcomes,
        row_of=lambda job: f"{job.network} ({job.weights})",
        column_of=lambda job: job.subset,
    )
