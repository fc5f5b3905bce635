"""`gonio export`: a material for another program."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._formats import ListingFormats
from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from gonio.exchange import Exported
    from nnbrdf.metrics import Errors


@click.command(name="export", cls=ListingFormats, writing=True)
@click.argument("what", metavar="SESSION|MODEL|TABLE")
@click.option(
    "--to", "name", type=str.lower, required=True, metavar="FORMAT", help="One of those below."
)
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="The file; if it is there, it is replaced.  [default: here, by the material's name; "
    "what is there already is kept]",
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
    table or any file that gonio import reads; a name from gonio materials works as well. Of
    formats that gonio reads the file is read back, and its error at the 81 x 81 pairs is told; the
    networks (onnx, glsl, c, mitsuba) are not read back. Told, too, is what the format loses.

    \b
    Examples:
        gonio export session/ --to csv
        gonio export session/ --to rgl -o leather.bsdf
        gonio export session/ --to mitsuba -o leather.py
        gonio export session/ --to merl --isotropic
        gonio export table.npz --to klems
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.api.opened import source_named
    from gonio.cli._console import console, note, progress_bar
    from gonio.exchange import export, format_named
    from gonio.report.gridded import is_slow

    format_ = format_named(name)
    source = source_named(what)
    if is_slow(source.material):
        note(
            f"{source.name} is a posterior, exact and slow to evaluate: a fine format takes hours; "
            "a network, as gonio reconstruct makes it by default, takes seconds"
        )
    if isotropic:
        source = source.averaged()
    with progress_bar(f"writing {format_.name}") as progress:
        exported = export(source, format_, output, progress)
    console.print(_said(exported))
    answer(_document(exported))


def _document(exported: Exported) -> dict[str, object]:
    format_ = exported.format
    return {
        "file": exported.path,
        "file_bytes": exported.path.stat().st_size,
        "format": format_.name,
        "keeps": format_.keeps,
        "loses": format_.loses,
        "notes": exported.notes,
        "eps8": exported.eps8,
        "male": exported.male,
        "of_mean": exported.of_mean and exported.of_mean._asdict(),
    }


def _said(exported: Exported) -> str:
    from gonio.words import size

    path, format_ = exported.path, exported.format
    lines = [
        f"wrote {path} ({size(path.stat().st_size)}): {format_.title}",
        f"keeps {format_.keeps}",
        f"loses {format_.loses}",
        *(f"note: {note}" for note in exported.notes),
        _error_said(exported),
    ]
    return "\n".join(lines)


def _error_said(exported: Exported) -> str:
    if exported.errors is None:
        return f"not read back: gonio does not read {exported.format.name}"
    told = f"read back at the 81 x 81 pairs: {_both(exported.errors)}"
    if exported.of_mean is None:
        return told
    return f"{told} against the material, {_both(exported.of_mean)} against its mean over turns"


def _both(errors: Errors) -> str:
    return f"eps8 {errors.eps8:.3g}, male {errors.male:.3g}"
