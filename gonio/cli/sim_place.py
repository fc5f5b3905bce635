"""`gonio sim place`: lay the white reference or the sample into a served twin's holder."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from gonio.cli._served import at_option, tell

if TYPE_CHECKING:
    from pathlib import Path


@click.command(name="place")
@click.argument("what", type=click.Choice(["reference", "sample"]))
@at_option
def command(what: str, at: Path) -> None:
    """Lay the white reference or the sample into a served twin's holder.

    The rig file of a served twin names this as its changer's command, so that a capture does it.
    """
    tell(at, f"place {what}")
