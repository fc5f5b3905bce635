"""`gonio export`: a material for another program."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._formats import ListingFormats
from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from gonio.exchange import Exported, Format, Source


@click.command(name="export", cls=ListingFormats, writing=True)
@click.argument("what", metavar="SESSION|MODEL|TABLE")
@click.option(
    "--to", "name", type=str.lower, required=True, metavar="FORMAT", help="One of those below."
)
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="The file.  [default: here, by the material's name]",
)
@click.option(
    "--isotropic",
    is_flag=True,
    help="Write the mean over all turns of the sample about its normal: for formats that hold "
    "isotropic materials only, or for smaller files.",
)
@answers
def command(*, what: str, name: str, output: Path | None, isotropic: bool) -> None:
    """Write a material in the format of another program.

    SESSION is a session's folder with a model (gonio reconstruct), MODEL a model's folder, TABLE a
    table or any file that gonio import reads; a name from gonio materials works as well. The
    file is read back, and its error at the 81 x 81 pairs is told with what the format loses.

    \b
    Examples:
        gonio export session/ --to csv
        gonio export session/ --to rgl -o leather.bsdf
        gonio export session/ --to mitsuba -o leather.py
        gonio export session/ --to merl --isotropic
        gonio export table.npz --to klems
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.api.opened import source_named
    from gonio.cli._console import console, progress_bar
    from gonio.exchange import export, format_named

    format_ = format_named(name)
    source = source_named(what)
    if isotropic:
        source = source.averaged()
    path = output or _default(what, source, format_)
    with progress_bar(f"writing {format_.name}") as progress:
        exported = export(source, format_, path, progress)
    console.print(_said(exported, path))
    answer(_document(exported, path))


def _default(what: str, source: Source, format_: Format) -> Path:
    from gonio.errors import BadInputError
    from gonio.exchange.networks.portable import symbol_of

    # a module's name is an identifier, or nobody can import it
    name = symbol_of(source.name) if format_.suffix == ".py" else source.name
    path = Path(f"{name}{format_.suffix}")
    if path.exists() and Path(what).exists() and path.samefile(what):
        raise BadInputError(f"{path}: is what is to be exported; name the new file with -o")
    return path


def _document(exported: Exported, path: Path) -> dict[str, object]:
    format_ = exported.format
    return {
        "file": path,
        "file_bytes": path.stat().st_size,
        "format": format_.name,
        "keeps": format_.keeps,
        "loses": format_.loses,
        "notes": exported.notes,
        "eps8": exported.eps8,
        "male": exported.male,
    }


def _said(exported: Exported, path: Path) -> str:
    from gonio.words import size

    format_ = exported.format
    lines = [
        f"wrote {path} ({size(path.stat().st_size)}): {format_.title}",
        f"keeps {format_.keeps}",
        f"loses {format_.loses}",
        *(f"note: {note}" for note in exported.notes),
    ]
    if exported.eps8 is not None:
        lines.append(
            f"read back at the 81 x 81 pairs: eps8 {exported.eps8:.3g}, male {exported.male:.3g}"
        )
    return "\n".join(lines)
