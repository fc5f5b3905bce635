"""`gonio study`: the paper's experiment and its neighbors, on any material."""

from __future__ import annotations

import click

from gonio.cli._lazy import LazyGroup

STUDIES = {
    "activations": "The paper's tables: twenty activations, two networks, four subsets.",
    "encodings": "Six ways to turn two directions into inputs.",
    "topology": "Networks from 83 to 5187 weights: error against training time.",
    "analytic": "Sixteen models of the literature beside the networks.",
    "shots": "Error against the number of shots, beside published methods.",
    "targets": "What the paper leaves unsaid: steps, scale of the targets, white.",
    "stability": "Stiff and extreme trainings: what happens, measured.",
    "dynamics": "The arm's physics: error against run time, and extreme cases held to bounds.",
}


@click.command(name="study", cls=LazyGroup, commands_of="gonio.cli.study_", helps=STUDIES)
def command() -> None:
    """Train many networks on a known material, and compare them in tables and a page.

    MATERIAL is a name of gonio materials, or an .npz table; several give a section each. Of
    the long studies every finished training is kept: the same command goes on where it was
    stopped, and a longer one uses what is there.

    \b
    Examples:
        gonio study activations wood-veneer
        gonio study activations felt.npz --activations softsign,tanh,gelu --subsets vs-is
        gonio study encodings satin brushed-metal -o encodings/
    """  # noqa: D301
