"""`gonio import`: a material from another program."""

from __future__ import annotations

from pathlib import Path

import click

from gonio.cli._formats import ListingFormats
from gonio.cli._json import answer, answers


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
    help="The table.  [default: here, by the file's name]",
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
    from gonio.errors import BadInputError
    from gonio.exchange import import_file

    path = output or Path(f"{file.stem}.npz")
    if path.exists() and file.exists() and path.samefile(file):
        raise BadInputError(f"{path}: is the file to be imported; name the table with -o")
    imported = import_file(file, path, name)
    console.print(
        f"read {file}: {imported.format.title}\n"
        f"wrote {path}: white {imported.table.white:.4g} 1/sr, changes by "
        f"{imported.source.anisotropy:.0%} when turned\n"
        f"measure it: gonio capture --sim --material {path}"
    )
    answer(
        {
            "file": path,
            "format": imported.format.name,
            "white_per_sr": imported.table.white,
            "anisotropy": imported.source.anisotropy,
        }
    )
