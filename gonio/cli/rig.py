"""`gonio rig`: what is to be known of a rig."""

from __future__ import annotations

import click

from gonio.cli._lazy import LazyGroup

ACTIONS = {
    "check": "Look at every device, and say what to do about what is wrong.",
    "home": "Find the axes' positions; everything moves.",
    "jog": "Move one axis.",
    "stop": "Stop all axes, switch the lamps off, end whoever drives the rig.",
    "bench": "Measure speeds, settling, homing and frames; writes rig-timing.json.",
}


@click.command(name="rig", cls=LazyGroup, commands_of="gonio.cli.rig_", helps=ACTIONS)
def command() -> None:
    """Look after a rig: is all of it there, where is it, how does it act.

    \b
    Examples:
        gonio rig check --rig rig.toml
        gonio rig home --rig rig.toml
        gonio rig jog view_theta +5 --rig rig.toml
        gonio rig stop --rig rig.toml
        gonio rig bench --rig rig.toml
        gonio plan --timing rig-timing.json
    """  # noqa: D301
