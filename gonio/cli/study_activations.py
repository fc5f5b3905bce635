"""`gonio study activations`: the paper's tables 2 and 3."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import click

from gonio.cli._study import conclude, names_in, networks_in, study_options

if TYPE_CHECKING:
    from gonio.cli._study import Setting

TITLE = "Activations"
ABOUT = (
    "Every activation on the same pairs, with the recipe of Mikes and Haindl (2023). Cells are "
    "medians over the seeds; ranks go by the mean of the cells."
)


@click.command(name="activations")
@study_options
@click.option("--activations", help="Names, with commas between.  [default: all twenty]")
@click.option("--networks", default="15-30-20,3-6-4", show_default=True, help="Hidden layers.")
def command(setting: Setting, *, activations: str | None, networks: str) -> None:
    """Compare activations on MATERIALS: errors, learning times, ranks.

    \b
    Examples:
        gonio study activations wood-veneer
        gonio study activations felt.npz silk.npz --activations softsign,tanh,gelu
    """  # noqa: D301
    from nnbrdf.activations import ACTIVATIONS
    from nnbrdf.studies.designs import combinations

    names = names_in(activations, list(ACTIVATIONS), "activation")
    design = partial(combinations, activations=names, networks=networks_in(networks))
    outcomes = setting.train(design)
    page = setting.folder / "activations.html"
    conclude(page, TITLE, ABOUT, outcomes, lambda job: job.activation)
