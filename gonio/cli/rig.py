"""`gonio rig`: what is to be known of a rig."""

from __future__ import annotations

import click

from gonio.cli._lazy import LazyGroup

ACTIONS = {"bench": "Measure speeds, settling, homing and frames; writes rig-timing.json."}


@click.command(name="rig", cls=LazyGroup, commands_of="gonio.cli.rig_", helps=ACTIONS)
def command() -> None:
    """Find out how a rig acts, which its rig file does not say.

    \b
    Examples:
        gonio rig bench --sim
        gonio plan --timing rig-timing.json
    """  # noqa: D301
