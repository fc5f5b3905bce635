"""`gonio prior`: what materials look like before they are measured."""

from __future__ import annotations

import click

from gonio.cli._lazy import LazyGroup

ACTIONS = {"build": "Make a prior from generated materials and your own finished sessions."}


@click.command(name="prior", cls=LazyGroup, commands_of="gonio.cli.prior_", helps=ACTIONS)
def command() -> None:
    """Make and extend the prior that gonio plan and gonio reconstruct work with.

    \b
    Examples:
        gonio prior build archive/ -o ours.npz
        gonio plan --prior ours.npz
    """  # noqa: D301
