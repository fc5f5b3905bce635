"""`gonio reconstruct`: from a session, or a table of samples, to an NN-BRDF and a report."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from gonio.protocols import Estimator
    from gonio.report.summary import Summary
    from gonio.samples import Samples
    from gonio.session import Session

SIZES = {"1268": (15, 30, 20), "88": (3, 6, 4)}


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
    type=click.Choice(["paper"]),
    default="paper",
    show_default=True,
    help="How samples become a material.",
)
@click.option(
    "--weights",
    type=click.Choice(list(SIZES)),
    default="1268",
    show_default=True,
    help="Size of the network: hidden layers 15-30-20 or 3-6-4.",
)
@click.option("--epochs", type=click.IntRange(min=1), default=500, show_default=True)
@click.option(
    "--steps",
    type=click.IntRange(min=1),
    help="Train for so many steps instead of epochs; 103000 are 500 epochs of all 6561 pairs.",
)
@click.option(
    "--activation",
    default="softsign",
    show_default=True,
    help="Of the hidden layers: tanh, gelu, relu, ... (any other word lists all twenty).",
)
@click.option(
    "--encoding",
    default="xyz",
    show_default=True,
    help="Inputs made of the directions: sincos, half-difference, ... (any other word lists all).",
)
@click.option(
    "--trainer",
    type=click.Choice(["fused", "torch", "cuda"]),
    help="Who trains: the compiled kernel, torch, or torch on a GPU.  [default: the kernel]",
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
def command(
    *,
    source: Path,
    output: Path | None,
    estimator: str,
    weights: str,
    epochs: int,
    steps: int | None,
    activation: str,
    encoding: str,
    trainer: str | None,
    seed: int,
) -> None:
    """Turn SOURCE into a material for the whole hemisphere, with error bars.

    SOURCE is a session's folder (its raw frames are reduced first, unless gonio reduce has
    done it since the last of them), or a CSV table from any other rig with the columns
    light_theta_deg, light_phi_deg, view_theta_deg, view_phi_deg, r, g, b (or one y) and,
    where known, sigma_r, sigma_g, sigma_b (or sigma_y).

    \b
    Examples:
        gonio reconstruct session/
        gonio reconstruct session/ --steps 103000
        gonio reconstruct samples.csv -o model/
    """  # noqa: D301
    from nnbrdf.estimators import estimator_named

    recipe = estimator_named(estimator)(
        hidden=SIZES[weights],
        epochs=epochs,
        steps=steps,
        seed=seed,
        activation=activation,
        encoding=encoding,
        trainer=trainer,
    )
    if source.is_file():
        _from_table(recipe, source, output or source.parent / "model")
    else:
        _from_session(recipe, source, output)


def _from_table(recipe: Estimator, table: Path, folder: Path) -> None:
    from gonio.report import write_report
    from gonio.tables import read_table

    samples = read_table(table)
    _fit(recipe, samples, folder)
    page = folder / "report.html"
    _show(write_report(page, model=folder, samples=samples), folder, page)


def _from_session(recipe: Estimator, root: Path, output: Path | None) -> None:
    from gonio.report import write_report
    from gonio.session import Session

    session = Session.open(root)
    folder = output or session.model
    with session.lock():
        samples = _reduced(session)
        session.note_timing("reconstruct", _fit(recipe, samples, folder))
        page = folder / "report.html" if output else session.report_path
        summary = write_report(page, model=folder, samples=samples, session=session)
    _show(summary, folder, page)


def _reduced(session: Session) -> Samples:
    from gonio.cli._console import progress_bar
    from gonio.files import sha256_file
    from gonio.reduce import is_reduced, reduce_session
    from gonio.samples import Samples

    if is_reduced(session):
        samples = Samples.load(session.samples_path)
    else:
        began = time.perf_counter()
        with progress_bar("reducing") as progress:
            samples = reduce_session(session, progress=progress)
        session.note_timing("reduce", time.perf_counter() - began)
    made_from = samples.provenance | {"samples": sha256_file(session.samples_path)}
    return replace(samples, provenance=made_from)


def _fit(recipe: Estimator, samples: Samples, folder: Path) -> float:
    from gonio.cli._console import progress_bar

    began = time.perf_counter()
    with progress_bar("training") as progress:
        estimate = recipe.fit(samples, progress)
    estimate.save(folder)
    return time.perf_counter() - began


def _show(summary: Summary, folder: Path, page: Path) -> None:
    from gonio.cli._console import console

    console.print(summary.table())
    console.print(f"model:  {folder}")
    console.print(f"report: {page}")
