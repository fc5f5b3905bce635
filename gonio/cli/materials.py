"""`gonio materials`: what the simulated rig can carry, with a picture each."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from rich.table import Table


@click.command(name="materials")
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Also draw them larger, side by side, into this PNG file.",
)
@answers
def command(output: Path | None) -> None:
    """Show the materials that the simulated rig can carry.

    Each is drawn on a sphere under a softbox from the upper left, its marked edge (+x, the grain)
    running from left to right. Anisotropy is how much the material changes when it is turned.

    \b
    Examples:
        gonio materials
        gonio materials -o materials.png
        gonio capture --sim --material brushed-metal
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.cli._console import console

    console.print(_table(pictures=console.color_system is not None))
    console.print("A file works as well: --material table.npz, or one that gonio import reads")
    if output is not None:
        _draw(output)
        console.print(f"wrote {output}")
    answer({"materials": _documents(), "picture": output})


def _documents() -> list[dict[str, object]]:
    from sim.materials import EMBEDDED, anisotropy

    return [
        {
            "name": name,
            "anisotropy": anisotropy(embedded.material),
            "description": embedded.description,
        }
        for name, embedded in EMBEDDED.items()
    ]


def _table(*, pictures: bool) -> Table:
    from rich.table import Table

    from gonio.cli._thumbnail import thumbnail
    from sim.materials import EMBEDDED, anisotropy

    table = Table(box=None, padding=(0, 2, 1 if pictures else 0, 0))
    table.add_column("material", no_wrap=True)
    if pictures:
        table.add_column("", no_wrap=True)
    table.add_column("anisotropy", justify="right")
    table.add_column("description")
    for name, embedded in EMBEDDED.items():
        picture = [thumbnail(embedded.material)] if pictures else []
        table.add_row(name, *picture, _percent(anisotropy(embedded.material)), embedded.description)
    return table


def _percent(share: float) -> str:
    return "none" if share < 0.005 else f"{100 * share:.0f} %"


def _draw(output: Path) -> None:
    from gonio.report.contact_sheet import write_contact_sheet
    from sim.materials import EMBEDDED

    write_contact_sheet(output, {name: embedded.material for name, embedded in EMBEDDED.items()})
