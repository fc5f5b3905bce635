"""What the studies share at their beginning: options read, materials and subsets laid out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from gonio.cli._console import progress_bar
from gonio.errors import BadInputError
from gonio.files import sha256_bytes
from nnbrdf.fused import MOST_LAYERS
from nnbrdf.studies.designs import Extent
from nnbrdf.studies.job import MOST_STEPS
from nnbrdf.studies.run import run_jobs
from nnbrdf.studies.train import Truth
from nnbrdf.training import default_trainer

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from nnbrdf.studies.job import Job, Outcome

SIXTH = 14
_MOST_SEEDS, _MOST_EPOCHS = 1000, 10**6
_SCALE = 1e9


@dataclass(frozen=True)
class Setting:
    """What the options of a study say."""

    truths: dict[str, Truth]
    subsets: dict[str, NDArray[np.int64]]
    extent: Extent
    folder: Path

    @property
    def notes(self) -> list[tuple[str, str]]:
        """What a page says of how its networks were trained."""
        trainers = {"fused": "gonio's compiled kernel", "torch": "torch"}
        seeds, epochs = self.extent.seeds, self.extent.epochs
        length = "as --steps says" if self.extent.steps else f"{epochs} epochs"
        pairs = ", ".join(
            f"{name}: {count} pairs, {self.extent.steps_on(name):,} steps"
            for name, count in self.extent.sizes.items()
        )
        return [
            ("networks for each case", str(seeds)),
            ("length of training", f"{length} ({pairs})"),
            ("trainer", trainers[default_trainer()]),
            ("times", "of the processor, on one core, unless a heading says otherwise"),
            *metric_notes(self.truths),
        ]

    def train(self, design: Callable[[Truth, Extent], list[Job]]) -> list[Outcome]:
        """Carry out a design on every material."""
        return self.outcomes(
            [job for truth in self.truths.values() for job in design(truth, self.extent)]
        )

    def outcomes(self, jobs: Sequence[Job]) -> list[Outcome]:
        """Carry out what is missing, with a bar on the screen."""
        with progress_bar("training") as progress:
            return run_jobs(jobs, self.truths, self.subsets, self.folder, progress)


def read_setting(
    materials: Sequence[str],
    folder: Path,
    subsets: str,
    *,
    seeds: int,
    epochs: int,
    steps: int | None,
) -> Setting:
    """Read the materials and lay out the subsets.

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown material or subset, two materials of one name, or a folder that is a file.
    """
    if folder.exists() and not folder.is_dir():
        raise BadInputError(f"{folder} is a file; give a folder for the study")
    pairs = _subsets(subsets)
    sizes = {name: len(chosen) for name, chosen in pairs.items()}
    truths: dict[str, Truth] = {}
    for name in materials:
        truth = _truth(name)
        if truth.name in truths:
            raise BadInputError(f"two materials are called {truth.name}; rename one, or drop it")
        truths[truth.name] = truth
    return Setting(truths, pairs, Extent(sizes, seeds, epochs, steps), folder)


def metric_notes(truths: dict[str, Truth]) -> list[tuple[str, str]]:
    """Return what a page says of its metrics, and the white that they hang on."""
    whites = ", ".join(f"{name} {truth.white:.4g}" for name, truth in truths.items())
    return [
        ("eps8", "mean absolute error on an 8-bit scale that ends at white, as the paper's"),
        ("male", "mean absolute error of the natural logarithm, above a floor of 1 % of white"),
        ("white (1/sr)", whites),
    ]


def names_in(text: str | None, known: Sequence[str], what: str) -> tuple[str, ...]:
    """Split names at commas, in small letters or capitals; all where there is no text.

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown name, listing the known.
    """
    if text is None:
        return tuple(known)
    names = tuple(dict.fromkeys(name.strip() for name in text.lower().split(",")))
    for name in names:
        if name not in known:
            raise BadInputError(f"{what} {name!r} is not known; use {', '.join(known)}")
    return names


def networks_in(text: str) -> tuple[tuple[int, ...], ...]:
    """Read hidden layers as people write them: 15-30-20,3-6-4.

    Raises
    ------
    gonio.errors.BadInputError
        For anything else, no units, or more layers than the compiled trainer takes.
    """
    try:
        networks = tuple(
            tuple(int(size) for size in each.split("-"))
            for each in dict.fromkeys(text.replace(" ", "").split(","))
        )
    except ValueError:
        networks = ()
    too_deep = any(len(hidden) >= MOST_LAYERS for hidden in networks)
    if not networks or too_deep or not all(1 <= size <= 512 for each in networks for size in each):
        raise BadInputError(
            f"networks {text!r} are none; write up to {MOST_LAYERS - 1} hidden layers of 1 to 512 "
            "like 15-30-20,3-6-4"
        )
    return networks


def study_options(command: Callable[..., None]) -> Callable[..., None]:
    """Add what every study takes; the command gets it read, as its first argument."""

    @wraps(command)
    def with_setting(
        *,
        materials: tuple[str, ...],
        output: Path,
        subsets: str,
        seeds: int,
        epochs: int,
        steps: int | None,
        **others: Any,
    ) -> None:
        setting = read_setting(materials, output, subsets, seeds=seeds, epochs=epochs, steps=steps)
        command(setting, **others)

    options = [
        click.argument("materials", nargs=-1, required=True),
        click.option("-o", "--output", type=click.Path(path_type=Path), default=Path("study"),
                     show_default=True, help="Folder of results; what it holds counts."),
        click.option("--subsets", default="va-ia,vs-ia,va-is,vs-is", show_default=True,
                     help="Pairs to train on: v views, i lights, a all, s a sixth."),
        click.option("--seeds", type=click.IntRange(1, _MOST_SEEDS), default=5, show_default=True,
                     help="Networks for each case; tables give their median."),
        click.option("--epochs", type=click.IntRange(1, _MOST_EPOCHS), default=500,
                     show_default=True, help="How often training sees each pair."),
        click.option("--steps", type=click.IntRange(1, MOST_STEPS),
                     help="Train for so many batches of 32 instead of epochs."),
    ]  # fmt: skip
    for option in reversed(options):
        option(with_setting)
    return with_setting


def _truth(name: str) -> Truth:
    from gonio.directions import paper_directions
    from gonio.materials import MeasuredTable
    from sim.materials import load_material

    material = load_material(name)
    if not isinstance(material, MeasuredTable):
        grid = paper_directions()
        material = MeasuredTable.of(material.evaluate(grid[:, None], grid[None]))
    values = np.ascontiguousarray(material.values, np.float64)
    largest, white = float(values.max()), float(material.white)
    if not all(1 / _SCALE <= each <= _SCALE for each in (largest, white)):
        raise BadInputError(
            f"{name}: the largest value is {largest:.3g} and white {white:.3g}; studies take "
            f"{1 / _SCALE:g} to {_SCALE:g}, so check that values are in 1/sr"
        )
    digest = sha256_bytes(values.tobytes() + np.float64(white).tobytes())
    return Truth(Path(name).stem, digest, values, white)


def _subsets(names: str) -> dict[str, NDArray[np.int64]]:
    """Return indices of the flattened grid; a sixth is spread from the pole, alike on both arms."""
    from gonio.directions import paper_directions
    from planner.density import PAPER_SUBSETS
    from planner.subset import farthest_points

    directions = paper_directions()
    every = np.arange(len(directions))
    arms = {"all": every, "sixth": farthest_points(directions, SIXTH, start=0)}
    return {
        name: (arms[lights][:, None] * len(every) + arms[views][None, :]).ravel()
        for name in names_in(names, list(PAPER_SUBSETS), "subset")
        for views, lights in [PAPER_SUBSETS[name]]
    }
