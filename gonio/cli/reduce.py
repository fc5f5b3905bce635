"""`gonio reduce`: from a session's raw frames to BRDF samples."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.core import ParameterSource

from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from rich.table import Table

    from gonio.samples import Samples
    from gonio.session import Session


_OF_TEXELS = frozenset(
    {
        "root",
        "btf",
        "texels",
        "scheduler",
        "anew",
        "geometry_path",
        "space",
        "color_path",
        "as_json",
    }
)


@click.command(name="reduce")
@click.argument("root", metavar="[SESSION]", type=click.Path(path_type=Path), default="session")
@click.option(
    "--patch-mm",
    type=float,
    help="Side of the square about the sample's centre that each sample is the mean over.  "
    "[default: of 20 pixels, 5 to 10 mm]",
)
@click.option(
    "--csv",
    "table",
    metavar="FILE",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write a table of the samples, too.",
)
@click.option(
    "--quantity",
    type=click.Choice(["brdf", "reflectance-factor"]),
    default="brdf",
    show_default=True,
    help="What the table holds: f in 1/sr, or pi f, which is 1 for a perfect diffuser.",
)
@click.option(
    "--radiance",
    "radiance",
    type=click.Path(file_okay=False, path_type=Path),
    metavar="DIR",
    help="Also merge each shot's bracket pixel by pixel, into a file of light and its variance.",
)
@click.option(
    "--geometry",
    "geometry_path",
    type=click.Path(path_type=Path),
    help="Camera and view arm as gonio geometry found them; the session keeps a copy and is "
    "reduced by it from then on.  [default: the one it keeps, or else the rig file's]",
)
@click.option(
    "--space",
    type=click.Choice(["linear-srgb", "xyz", "acescg", "camera"]),
    help="Color space of the values: linear sRGB, XYZ or ACEScg by the color file or else the "
    "frames' own matrix, or the camera's own channels, white-balanced.  [default: that of the "
    "samples that are there, or else linear-srgb]",
)
@click.option(
    "--color",
    "color_path",
    type=click.Path(path_type=Path),
    help="The camera's matrix as gonio color found it; the session keeps a copy and is reduced by "
    "it from then on.  [default: the one it keeps, or else the frames' own matrix]",
)
@click.option("--btf", is_flag=True, help="Make btf.zarr instead: a picture for each pair.")
@click.option(
    "--texels",
    type=int,
    help="With --btf: texels along a side.  [default: one for each pixel seen from above]",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="With --btf: a Dask scheduler, tcp://host:8786, whose workers share this folder.  "
    "[default: a process for each core here]",
)
@click.option(
    "--anew",
    is_flag=True,
    help="With --btf: begin afresh instead of going on where an earlier run was interrupted.",
)
@answers
def command(
    *,
    root: Path,
    patch_mm: float | None,
    table: Path | None,
    quantity: str,
    radiance: Path | None,
    geometry_path: Path | None,
    space: str | None,
    color_path: Path | None,
    btf: bool,
    texels: int | None,
    scheduler: str | None,
    anew: bool,
) -> None:
    """Turn the raw frames of SESSION into BRDF samples, each with its sigma.

    The samples go into samples.nc in the session's folder, in 1/sr and the color space asked for,
    which the file states with what it was made by. `gonio
    reconstruct` does this first by itself; this command is for those who want the samples alone,
    or a patch of another size.

    \b
    Examples:
        gonio reduce session/
        gonio reduce session/ --patch-mm 20
        gonio reduce session/ --csv factors.csv --quantity reflectance-factor
        gonio reduce session/ --radiance light/
        gonio reduce session/ --geometry geometry.json
        gonio reduce session/ --color color.json --space acescg
        gonio reduce session/ --btf --scheduler tcp://node1:8786
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.api.reduction import reduce_anew
    from gonio.api.told import checks_document, samples_document
    from gonio.cli._checks import tell_checks
    from gonio.cli._console import console, progress_bar
    from gonio.errors import BadInputError
    from gonio.reduce import usual_patch_mm, write_radiance, write_table
    from gonio.session import Session

    if btf:
        from gonio.cli._btf import reduce_to_texels

        _refuse_idle()
        reduce_to_texels(root, texels, scheduler, space, color_path, geometry_path, anew=anew)
        return
    if texels is not None or scheduler is not None or anew:
        raise click.UsageError("--texels, --scheduler and --anew are options of --btf; add that")
    if table is None and quantity != "brdf":
        raise BadInputError(f"--quantity {quantity} is of a table; name one with --csv FILE")
    session = Session.open(root)
    _check_targets(session, table, radiance)
    if patch_mm is None:
        patch_mm = usual_patch_mm(session.rig().camera)
    began = time.perf_counter()
    with progress_bar("reducing") as progress:
        samples = reduce_anew(
            session, geometry_path, color_path, progress, patch_mm=patch_mm, space=space
        )
    shots, seconds = len(session.chain().shots), time.perf_counter() - began
    console.print(_table(samples, shots, seconds))
    tell_checks(session)
    console.print(f"samples: {session.samples_path}")
    if table is not None:
        write_table(table, samples, quantity)
        console.print(f"table of {quantity}: {table}")
    if radiance:
        with session.lock(), progress_bar("merging") as progress:
            written = write_radiance(session, radiance, progress)
        console.print(f"light of {written} shots: {radiance}")
    answer(
        {
            "file": session.samples_path,
            "table": table,
            "radiance": radiance,
            "shots_planned": shots,
            "took_s": seconds,
            **samples_document(samples),
            **checks_document(session.checks_path),
        }
    )


def _check_targets(session: Session, table: Path | None, radiance: Path | None) -> None:
    """Refuse to write over what the session is made of, or among it."""
    from gonio.errors import BadInputError

    root = session.root.resolve()
    others = table is not None and table.exists() and table.suffix.lower() != ".csv"
    if table is not None and others and table.resolve().is_relative_to(root):
        raise BadInputError(f"{table}: is a file of the session; name another with --csv")
    own = [root, session.raw, session.calibration, session.plans, session.sim, session.model]
    if radiance is not None and radiance.resolve() in {each.resolve() for each in own}:
        raise BadInputError(f"{radiance}: is the session's; name a folder of its own")


def _refuse_idle() -> None:
    """Refuse options of the samples, which --btf does not make."""
    context = click.get_current_context()
    for parameter in context.command.params:
        typed = context.get_parameter_source(parameter.name or "") is ParameterSource.COMMANDLINE
        if typed and parameter.name not in _OF_TEXELS:
            raise click.UsageError(
                f"{parameter.opts[0]} is an option of the samples, which --btf does not make; "
                "leave one out"
            )


def _table(samples: Samples, shots: int, seconds: float) -> Table:
    import numpy as np
    from rich.table import Table

    from gonio.api.told import flagged, relative_sigma
    from gonio.samples import Flag
    from gonio.words import duration

    relative = relative_sigma(samples)
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    table.add_row("shots planned", str(shots))
    table.add_row("samples", str(len(samples)))
    table.add_row("left out", str(shots - len(samples)))
    table.add_row("clipped", str(flagged(samples, Flag.CLIPPED)))
    table.add_row("faint", str(flagged(samples, Flag.FAINT)))
    by = f" by {samples.color_made_by}" if samples.color_made_by != "none" else ""
    table.add_row("values", f"{samples.color_space}{by}")
    table.add_row("median value", f"{np.median(samples.value):.4g} 1/sr")
    table.add_row("median sigma", "-" if relative is None else f"{100 * relative:.2g} %")
    table.add_row("time", duration(seconds))
    return table
