"""`gonio prior build`: a lab's own materials sharpen what is expected of the next."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from nnbrdf.prior.family import Family
    from nnbrdf.prior.learned import LearnedMaterial


@click.command(name="build")
@click.argument("folders", nargs=-1, type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    default=Path("prior.npz"),
    show_default=True,
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
@answers
def command(*, folders: tuple[Path, ...], output: Path, seed: int) -> None:
    """Make a prior of generated materials and of all models found in FOLDERS.

    FOLDERS hold sessions or models of estimator nn, at any depth. Ten of them count as much as
    all 2000 generated materials of a kind. Without folders the prior is the built-in one.

    \b
    Examples:
        gonio prior build archive/ -o ours.npz
        gonio plan --prior ours.npz
        gonio reconstruct session/ --prior ours.npz
    """  # noqa: D301
    from gonio.errors import BadInputError
    from nnbrdf.prior import MaterialPrior

    learned = list(_learned(folders))
    if folders and not learned:
        raise BadInputError(
            f"no model of estimator nn in {', '.join(map(str, folders))}; finish a session with: "
            "gonio reconstruct"
        )
    prior = MaterialPrior.generate(seed=seed).learn(learned)
    prior.save(output)
    for family in prior.families:
        click.echo(
            f"{family.name}: {len(family.examples)} generated, {len(family.learned)} measured, "
            f"which count {family.weights[len(family.examples) :].sum():.0%}"
        )
    click.echo(f"wrote {output}")
    answer(
        {"file": output, "sha256": prior.sha256, "families": list(map(_document, prior.families))}
    )


def _document(family: Family) -> dict[str, object]:
    return {
        "name": family.name,
        "generated": len(family.examples),
        "measured": len(family.learned),
        "measured_share": family.weights[len(family.examples) :].sum(),
    }


def _learned(folders: Sequence[Path]) -> Iterator[LearnedMaterial]:
    """Read the models below the folders, each once, whatever its folder is called.

    What is broken, of another kind, or there already, is named and skipped.
    """
    from gonio.cli._console import progress_bar
    from gonio.errors import BadFileError, BadInputError
    from gonio.files import sha256_file
    from nnbrdf.card import CARD_NAME
    from nnbrdf.load import load_model
    from nnbrdf.taught import TaughtBRDF
    from nnbrdf.weights import WEIGHTS_NAME

    for folder in folders:
        if not folder.is_dir():
            raise BadInputError(f"{folder} is no folder; name folders that hold sessions")
    seen: dict[str, Path] = {}
    cards = sorted({card for folder in folders for card in folder.rglob(CARD_NAME)})
    with progress_bar("reading models") as progress:
        for done, card in enumerate(cards, 1):
            try:
                model = load_model(card.parent)
            except BadFileError as error:
                click.echo(f"skipped: {error}", err=True)
                continue
            if not isinstance(model, TaughtBRDF):
                click.echo(
                    f"skipped: {card.parent} is of estimator {model.card.estimator}, not nn",
                    err=True,
                )
                continue
            digest = sha256_file(card.parent / WEIGHTS_NAME)
            if digest in seen:
                click.echo(f"skipped: {card.parent} is the same as {seen[digest]}", err=True)
                continue
            seen[digest] = card.parent
            yield replace(model.as_example(), source=str(card.parent), sha256=digest)
            progress(done, len(cards))
