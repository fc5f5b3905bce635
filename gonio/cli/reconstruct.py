"""`gonio reconstruct`: from a session, or a table of samples, to an NN-BRDF and a report."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from gonio.protocols import Estimator
    from gonio.report.summary import Summary
    from gonio.samples import Samples
    from gonio.session import Session
    from nnbrdf.compare import Trial

_PAPER_SIZES = {"1268": (15, 30, 20), "88": (3, 6, 4)}
_OF = {
    "weights": ("nn", "paper"), "general": ("nn",), "steps": ("nn", "paper"), "epochs": ("paper",),
    "encoding": ("paper",), "activation": ("nn", "paper"), "trainer": ("nn", "paper"),
    "seed": ("nn", "analytic", "paper"), "prior": ("nn", "prior"),
}  # fmt: skip


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
    recipe = _recipe(estimator, {k: v for k, v in settings.items() if v is not None})
    if source.is_file():
        _from_table(recipe, source, output or source.parent / "model", compare)
    else:
        _from_session(recipe, source, output, compare)


def _recipe(name: str, settings: dict[str, Any]) -> Estimator:
    """Return the estimator; options of others are refused, since they would do nothing."""
    from gonio.errors import BadInputError
    from nnbrdf.estimators import estimator_named

    for option in settings:
        if name not in _OF[option]:
            known = " and ".join(_OF[option])
            raise BadInputError(f"--{option} is an option of estimator {known}, not of {name}")
    if "prior" in settings:
        from gonio.cli._prior import material_prior

        settings["prior"] = material_prior(settings["prior"])
    size = settings.pop("weights", None)
    if size is not None and name == "nn":
        settings["size"] = size
    elif size is not None:
        if size not in _PAPER_SIZES:
            raise BadInputError(f"--weights {size}: estimator paper knows 88 and 1268")
        settings["hidden"] = _PAPER_SIZES[size]
    return estimator_named(name)(**settings)


def _from_table(recipe: Estimator, table: Path, folder: Path, compare: bool) -> None:
    from gonio.report import write_report
    from gonio.tables import read_table

    page = folder / "report.html"
    _check_places(folder, page)
    samples = read_table(table)
    trial = _trial(samples, None) if compare else None
    _fit(recipe, samples, folder, page)
    if trial:
        _compare(recipe, trial, folder)
    _show(write_report(page, model=folder, samples=samples), folder, page)


def _from_session(recipe: Estimator, root: Path, output: Path | None, compare: bool) -> None:
    from gonio.report import write_report
    from gonio.session import Session

    session = Session.open(root)
    if output is None:
        session.check_writable("name a folder for the model with -o")
    folder = output or session.model
    page = folder / "report.html" if output else session.report_path
    _check_places(folder, page)
    with session.lock():
        samples = _reduced(session)
        trial = _trial(samples, session) if compare else None
        session.note_timing("reconstruct", _fit(recipe, samples, folder, page))
        if trial:
            _compare(recipe, trial, folder)
        prior = getattr(recipe, "prior", None)
        summary = write_report(page, model=folder, samples=samples, session=session, prior=prior)
    _show(summary, folder, page)


def _check_places(folder: Path, page: Path) -> None:
    """Refuse, before the training, where model and page could not be written after it."""
    from gonio.errors import StorageError
    from gonio.files import check_room

    # a model is written aside first
    for place in (folder.parent, folder, page.parent):
        check_room(place)
    if page.is_dir():
        raise StorageError(f"{page}: is a folder, where the report goes; move it away")


def _reduced(session: Session) -> Samples:
    from gonio.cli._samples import reduced
    from gonio.files import sha256_file

    samples = reduced(session)
    made_from = samples.provenance | {"samples": sha256_file(session.samples_path)}
    return replace(samples, provenance=made_from)


def _fit(recipe: Estimator, samples: Samples, folder: Path, page: Path) -> float:
    from gonio.cli._console import console, progress_bar
    from gonio.files import remove_file
    from gonio.words import several

    trusted = samples.trusted()
    if suspect := len(samples) - len(trusted):
        console.print(f"{several(suspect, 'suspect shot')} left out (gonio capture --retake)")
    began = time.perf_counter()
    with progress_bar("training") as progress:
        estimate = recipe.fit(trusted, progress)
    # a page tells of the model beside it or is not there, even if this is killed before the next
    remove_file(page)
    estimate.save(folder)
    return time.perf_counter() - began


def _trial(samples: Samples, session: Session | None) -> Trial:
    from gonio.report import truth_of
    from nnbrdf.compare import Trial

    return Trial.of(samples, truth_of(session, samples.color_space))


def _compare(recipe: Estimator, trial: Trial, folder: Path) -> None:
    from gonio.cli._console import console, progress_bar
    from gonio.words import duration
    from nnbrdf.compare import compare, competitors
    from nnbrdf.compared import save_entries

    began = time.perf_counter()
    estimators = competitors(getattr(recipe, "prior", None))
    entries = compare(trial, estimators, lambda name: progress_bar(f"comparing {name}"))
    save_entries(folder, entries)
    taken = duration(time.perf_counter() - began)
    console.print(f"compared {len(entries)} estimators in {taken}")


def _show(summary: Summary, folder: Path, page: Path) -> None:
    from gonio.cli._console import console

    console.print(summary.table())
    console.print(f"model:  {folder}")
    console.print(f"report: {page}")
