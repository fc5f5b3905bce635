"""`gonio btf`: what can be made of a picture for each pair of directions."""

from __future__ import annotations

import click

from gonio.cli._lazy import LazyGroup

ACTIONS = {"fit": "Train a network for each texel, and relight a patch that was held out."}


@click.command(name="btf", cls=LazyGroup, commands_of="gonio.cli.btf_", helps=ACTIONS)
def command() -> None:
    """Work with the pictures that gonio reduce --btf makes.

    \b
    Examples:
        gonio reduce session/ --btf
        gonio btf fit session/
    """  # noqa: D301
