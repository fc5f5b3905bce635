"""`gonio reconstruct`: from a session, or a table of samples, to an NN-BRDF and a report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from gonio.api.reconstruction import Reconstructed


@click.command(name="reconstruct")
@click.argument("source", type=click.Path(path_type=Path), default=Path("session"))
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="The model's folder.  [default: model/ in the session, or beside the table]",
)
@click.option(
    "--estimator",
    type=click.Choice(["nn", "prior", "analytic", "paper"], case_sensitive=False),
    default="nn",
    show_default=True,
    help="How samples become a material. nn: a small network taught by what a prior of generated "
    "materials makes of the samples. prior: that itself, exact and slow to evaluate. analytic: "
    "the model of the literature that fits best. paper: networks on the samples alone.",
)
@click.option(
    "--weights",
    type=click.Choice(["88", "1268", "2595", "9219"]),
    help="Size of the network, of nn at most; paper knows the first two.  [default: 1268, of nn "
    "fewer where these say as much]",
)
@click.option(
    "--general",
    is_flag=True,
    default=None,
    help="Leave nothing out: assume neither isotropy, nor reciprocity, nor channels that are "
    "multiples of one, and take no smaller network than asked for.",
)
@click.option(
    "--steps",
    type=click.IntRange(min=1),
    help="Batches of 32 to train for.  [default: nn 60000, paper as by --epochs]",
)
@click.option("--epochs", type=click.IntRange(min=1), help="Of estimator paper.  [default: 500]")
@click.option(
    "--activation",
    type=str.lower,
    metavar="NAME",
    help="Of the hidden layers: tanh, gelu, relu, ... (any other word lists all twenty).  "
    "[default: nn gelu, paper softsign]",
)
@click.option(
    "--encoding",
    type=str.lower,
    metavar="NAME",
    help="Inputs of estimator paper: xyz, sincos, half-difference, ... (any other word lists "
    "all).  [default: xyz]",
)
@click.option(
    "--trainer",
    type=click.Choice(["fused", "torch", "cuda"], case_sensitive=False),
    help="Who trains: the compiled kernel, torch, or torch on a GPU.  [default: the kernel]",
)
@click.option(
    "--prior",
    type=click.Path(dir_okay=False, path_type=Path),
    help="What materials look like (see gonio prior).  [default: generated ones]",
)
@click.option("--seed", type=click.IntRange(min=0), help="Of starts and orders.  [default: 0]")
@click.option(
    "--compare",
    is_flag=True,
    help="Also fit every estimator, at every size, and show error against time in the report: "
    "against the truth of a simulated session, else at every fifth sample, held out.",
)
@answers
def command(
    *,
    source: Path,
    output: Path | None,
    estimator: str,
    compare: bool,
    **settings: str | int | Path | None,
) -> None:
    """Turn SOURCE into a material for the whole hemisphere, with error bars.

    SOURCE is a session's folder (its raw frames are reduced first, unless gonio reduce has
    done it since the last of them), or a CSV table from any other rig with the columns
    light_theta_deg, light_phi_deg, view_theta_deg, view_phi_deg, r, g, b (or one y) and,
    where known, sigma_r, sigma_g, sigma_b (or sigma_y).

    \b
    Examples:
        gonio reconstruct session/
        gonio reconstruct session/ --weights 9219
        gonio reconstruct session/ --compare
        gonio reconstruct session/ --estimator paper --steps 103000 -o paper/
        gonio reconstruct samples.csv -o model/
    """  # noqa: D301
    from gonio.api.following import Following
    from gonio.api.reconstruction import Reconstruction, recipe_of
    from gonio.cli._console import note, progress_bar
    from gonio.session import Session
    from gonio.tables import read_table

    following = Following(bars=progress_bar, tell=note)
    reconstruction = Reconstruction(recipe_of(estimator, settings), following, compare)
    if source.is_file():
        folder = output or source.parent / "model"
        _show(reconstruction.of_samples(read_table(source), folder))
    else:
        _show(reconstruction.of_session(Session.open(source), output))


def _show(made: Reconstructed) -> None:
    from gonio.cli._console import console
    from gonio.words import duration

    if made.compared:
        seconds = sum(each.fit_seconds for each in made.compared)
        console.print(f"compared {len(made.compared)} estimators in {duration(seconds)} of fits")
    console.print(made.summary.table())
    console.print(f"model:  {made.model}")
    console.print(f"report: {made.report}")
    compared = [each.model_dump() for each in made.compared]
    found = {"model": made.model, "report": made.report, "compared": compared}
    answer({**found, **made.summary.document()})
