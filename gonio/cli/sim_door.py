"""`gonio sim door`: open or close a served twin's door."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from gonio.cli._served import at_option, tell

if TYPE_CHECKING:
    from pathlib import Path


@click.command(name="door")
@click.argument("state", type=click.Choice(["open", "closed"]))
@at_option
def command(state: str, at: Path) -> None:
    """Open or close a served twin's door.

    An open door stops every axis on a ramp and puts the lamps out, until it is closed.
    """
    tell(at, f"door {state}")
