"""`gonio sim`: the simulated rig over real wires."""

from __future__ import annotations

import click

from gonio.cli._lazy import LazyGroup

ACTIONS = {
    "serve": "Offer the twin at a real port, a real serial line and a real folder.",
    "place": "Lay the white reference or the sample into a served twin's holder.",
    "door": "Open or close a served twin's door, which is its interlock.",
    "power": "Cut the power of a served twin's drives, or bring it back.",
}


@click.command(name="sim", cls=LazyGroup, commands_of="gonio.cli.sim_", helps=ACTIONS)
def command() -> None:
    """Serve the simulated rig, as hardware would be there.

    \b
    Examples:
        gonio sim serve                            runs until Ctrl-C; then, in another shell:
        gonio capture --rig served/rig.toml
        gonio sim door open
    """  # noqa: D301
