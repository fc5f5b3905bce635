"""`gonio reduce`: from a session's raw frames to BRDF samples."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from rich.table import Table

    from gonio.samples import Samples


@click.command(name="reduce")
@click.argument("root", metavar="[SESSION]", type=click.Path(path_type=Path), default="session")
@click.option(
    "--patch-mm",
    type=float,
    default=5.0,
    show_default=True,
    help="Side of the square about the sample's centre that each sample is the mean over.",
)
def command(*, root: Path, patch_mm: float) -> None:
    """Turn the raw frames of SESSION into BRDF samples, each with its sigma.

    The samples go into samples.nc in the session's folder, in 1/sr and linear sRGB. `gonio
    reconstruct` does this first by itself; this command is for those who want the samples alone,
    or a patch of another size.

    \b
    Examples:
        gonio reduce session/
        gonio reduce session/ --patch-mm 10
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.cli._console import console, progress_bar
    from gonio.reduce import reduce_session
    from gonio.session import Session

    session = Session.open(root)
    began = time.perf_counter()
    with session.lock():
        with progress_bar("reducing") as progress:
            samples = reduce_session(session, patch_mm=patch_mm, progress=progress)
        seconds = time.perf_counter() - began
        session.note_timing("reduce", seconds)
    console.print(_table(samples, len(session.chain().shots), seconds))
    console.print(f"samples: {session.samples_path}")


def _table(samples: Samples, shots: int, seconds: float) -> Table:
    import numpy as np
    from rich.table import Table

    from gonio.samples import Flag
    from gonio.words import duration

    def count(flag: Flag) -> str:
        return str(int((samples.flag & flag.value).any(axis=1).sum()))

    # of a value about zero the ratio says nothing
    bright = samples.value > 0
    relative = samples.sigma[bright] / samples.value[bright]
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    table.add_row("shots planned", str(shots))
    table.add_row("samples", str(len(samples)))
    table.add_row("left out", str(shots - len(samples)))
    table.add_row("clipped", count(Flag.CLIPPED))
    table.add_row("faint", count(Flag.FAINT))
    table.add_row("median value", f"{np.median(samples.value):.4g} 1/sr")
    table.add_row("median sigma", f"{100 * np.median(relative):.2g} %" if relative.size else "-")
    table.add_row("time", duration(seconds))
    return table
