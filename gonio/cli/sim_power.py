"""`gonio sim power`: cut the power of a served twin's drives, or bring it back."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from gonio.cli._served import at_option, tell

if TYPE_CHECKING:
    from pathlib import Path


@click.command(name="power")
@click.argument("state", type=click.Choice(["off", "on"]))
@at_option
def command(state: str, at: Path) -> None:
    """Cut the power of a served twin's drives, or bring it back.

    Without it no unit answers; with it again no axis knows where it is, until it is homed.
    """
    tell(at, f"power {state}")
