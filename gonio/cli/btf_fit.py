"""`gonio btf fit`: a network for each texel, and one picture relit against what was measured."""

from __future__ import annotations

import time
from pathlib import Path

import click

from gonio.cli._json import answer, answers

# of a held-out picture's mean, from which on somebody should look
_POOR = 0.25


@click.command(name="fit")
@click.argument("root", metavar="[SESSION]", type=click.Path(path_type=Path), default="session")
@click.option(
    "--side", type=int, help="Texels along a side of the middle that is fitted.  [default: all]"
)
@click.option(
    "--steps",
    type=click.IntRange(min=3),
    default=600,
    show_default=True,
    help="Batches of 32 to train each texel for, from the network of the mean material.",
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
@answers
def command(*, root: Path, side: int | None, steps: int, seed: int) -> None:
    """Train an NN-BRDF of 88 weights for each texel of SESSION's btf.zarr.

    The weights go into btf-model/weights.npz as a texture. One pair is held out of the training;
    btf-model/relit.png shows its picture as measured and as the networks tell it.

    \b
    Examples:
        gonio btf fit session/
        gonio btf fit session/ --side 128       the middle alone, in a minute
    """  # noqa: D301
    from gonio.cli._console import console, note
    from gonio.cli._texel_fit import fit_middle
    from gonio.reduce.btf import Btf, Texels
    from gonio.session import Session
    from gonio.words import duration

    session = Session.open(root)
    session.check_writable("copy it to a folder that can be written")
    btf = Btf.open(session)
    texels = Texels(btf, btf.side if side is None else side)
    folder = root / "btf-model"
    began = time.perf_counter()
    with session.lock():
        error = fit_middle(texels, folder, steps, seed)
        seconds = time.perf_counter() - began
        session.note_timing("btf-fit", seconds)
    console.print(f"{texels.side} x {texels.side} networks of 88 weights, {duration(seconds)}")
    console.print(f"relit picture that was held out: off by {error:.1%} of its mean")
    if error > _POOR:
        note(
            "that is little to know of the directions between those measured: measure more pairs, "
            "or train longer with --steps"
        )
    console.print(f"weights: {folder / 'weights.npz'}")
    console.print(f"relit: {folder / 'relit.png'}")
    answer(
        {
            "folder": folder,
            "texels_along_side": texels.side,
            "relit_relative_error": error,
            "took_s": seconds,
        }
    )
