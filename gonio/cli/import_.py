"""`gonio import`: a material from another program."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._formats import ListingFormats
from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from gonio.exchange.importing import Imported


@click.command(name="import", cls=ListingFormats, writing=False)
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--from",
    "name",
    type=str.lower,
    metavar="FORMAT",
    help="One of those below.  [default: by the file's content]",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="The table, a name in .npz; if it is there, it is replaced.  [default: here, by the "
    "file's name; what is there already is kept]",
)
@answers
def command(*, file: Path, name: str | None, output: Path | None) -> None:
    """Make a material of FILE, which another program wrote, that gonio can measure.

    The table holds the 81 x 81 pairs, and beside them the file itself, so that the simulated rig
    carries the material on its own, finer grid.

    \b
    Examples:
        gonio import leather.bin
        gonio import alum-bronze.binary -o bronze.npz
        gonio capture --sim --material leather.npz
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.cli._console import console
    from gonio.exchange import import_file

    imported = import_file(file, output, name)
    console.print(_said(file, imported))
    answer(_document(imported))


def _said(file: Path, imported: Imported) -> str:
    format_ = imported.format
    lines = [
        f"read {file}: {format_.title}",
        f"keeps {format_.keeps}",
        f"loses {format_.loses}",
        *(f"note: {note}" for note in imported.notes),
        f"wrote {imported.path}: white {imported.table.white:.4g} 1/sr, changes by "
        f"{imported.source.anisotropy:.0%} when turned",
        f"measure it: gonio capture --sim --material {imported.path}",
    ]
    return "\n".join(lines)


def _document(imported: Imported) -> dict[str, object]:
    return {
        "file": imported.path,
        "format": imported.format.name,
        "keeps": imported.format.keeps,
        "loses": imported.format.loses,
        "notes": imported.notes,
        "white_per_sr": imported.table.white,
        "anisotropy": imported.source.anisotropy,
    }
