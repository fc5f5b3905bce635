"""`gonio study activations`: the paper's tables 2 and 3."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answers
from gonio.cli._study import names_in, networks_in, study_options
from gonio.cli._study_end import conclude

if TYPE_CHECKING:
    from gonio.cli._study import Setting

TITLE = "Activations"
ABOUT = (
    "Every activation on the same pairs, by absolute loss, Adamax and batches of 32, as Mikes and "
    "Haindl (2023) have it; for how long, the end of the page says. Cells are medians over the "
    "seeds; ranks go by the mean of the cells."
)


@click.command(name="activations")
@study_options
@click.option("--activations", help="Names, with commas between.  [default: all twenty]")
@click.option("--networks", default="15-30-20,3-6-4", show_default=True, help="Hidden layers.")
@answers
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
    conclude(setting, "activations", TITLE, ABOUT, outcomes, lambda job: job.activation)
