"""What the studies share: materials and subsets in, tables and a page out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click
import numpy as np

from gonio.cli._console import console, duration, progress_bar
from gonio.errors import BadInputError
from gonio.files import sha256_bytes
from nnbrdf.fused import MOST_LAYERS
from nnbrdf.studies.designs import Extent
from nnbrdf.studies.export import write_outcomes, write_table
from nnbrdf.studies.job import METRICS
from nnbrdf.studies.run import run_jobs
from nnbrdf.studies.tables import column_of, tabulate
from nnbrdf.studies.train import Truth

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from gonio.report.grids import Grid
    from nnbrdf.studies.job import Job, Outcome

SIXTH = 14
_WIDEST = 400


@dataclass(frozen=True)
class Setting:
    """What the options of a study say."""

    truths: dict[str, Truth]
    subsets: dict[str, NDArray[np.int64]]
    extent: Extent
    folder: Path

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


def names_in(text: str | None, known: Sequence[str], what: str) -> tuple[str, ...]:
    """Split names at commas, in small letters or capitals; all where there is no text.

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown name, listing the known.
    """
    if text is None:
        return tuple(known)
    names = tuple(name.strip() for name in text.lower().split(","))
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
            for each in text.replace(" ", "").split(",")
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
        click.option("--seeds", type=click.IntRange(min=1), default=5, show_default=True,
                     help="Networks for each case; tables give their median."),
        click.option("--epochs", type=click.IntRange(min=1), default=500, show_default=True),
        click.option("--steps", type=click.IntRange(min=1),
                     help="Train for so many steps instead of epochs."),
    ]  # fmt: skip
    for option in reversed(options):
        option(with_setting)
    return with_setting


def conclude(
    page: Path,
    title: str,
    about: str,
    outcomes: Sequence[Outcome],
    row_of: Callable[[Job], str],
    column_of: Callable[[Job], str] = column_of,
) -> None:
    """Write the CSV files of a study beside its page, and the page; print eps8, and the ranks."""
    from gonio.report.study import grid_of, section_of, summary_section, write_study

    tables = {
        metric: tabulate(outcomes, metric, row_of, column_of) for metric in (*METRICS, "seconds")
    }
    sections = [section_of(of_material) for of_material in zip(*tables.values(), strict=True)]
    summary = [summary_section(tables)] if len(sections) > 1 else []
    write_outcomes(page.parent / "results.csv", outcomes)
    for metric, of_metric in tables.items():
        write_table(page.parent / f"{metric}.csv", of_metric)
    write_study(page, title, about, [*sections, *summary])
    for table in tables["eps8"]:
        show_grids(table.material, [grid_of(table)])
    for section in summary:
        show_grids(section.title, section.grids)
    show_end(page, outcomes)


def show_grids(material: str, grids: Sequence[Grid]) -> None:
    """Print tables of one material."""
    from rich.console import Console
    from rich.measure import Measurement
    from rich.table import Table as Screen

    for grid in grids:
        screen = Screen(title=f"{material}: {grid.title}", box=None, title_justify="left")
        for index, name in enumerate(grid.head):
            justify: Literal["left", "right"] = "right" if index and not grid.words else "left"
            screen.add_column(name.replace(" ", "\n"), justify=justify, no_wrap=True)
        for line in grid.lines:
            screen.add_row(*line.cells, style="bold" if line.best else None)
        # a narrow terminal wraps the lines of a wide table; it must not cut its cells
        roomy = console.options.update(max_width=_WIDEST)
        width = max(console.width, Measurement.get(console, roomy, screen).maximum)
        Console(width=width, highlight=False).print(screen)


def show_end(page: Path, outcomes: Sequence[Outcome]) -> None:
    """Say where everything is, and what it took."""
    seconds = sum(outcome.seconds for outcome in outcomes)
    console.print(f"{len(outcomes)} trainings, {duration(seconds)} of one core in all")
    console.print(f"tables: {page.parent}")
    console.print(f"page:   {page}")


def _truth(name: str) -> Truth:
    from gonio.directions import paper_directions
    from gonio.materials import MeasuredTable
    from sim.materials import load_material

    material = load_material(name)
    if not isinstance(material, MeasuredTable):
        grid = paper_directions()
        material = MeasuredTable.of(material.evaluate(grid[:, None], grid[None]))
    values = np.ascontiguousarray(material.values, np.float64)
    digest = sha256_bytes(values.tobytes() + np.float64(material.white).tobytes())
    return Truth(Path(name).stem, digest, values, float(material.white))


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
