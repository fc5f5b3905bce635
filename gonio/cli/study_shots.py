"""`gonio study shots`: error against the number of shots."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

TITLE = "Shots"
ABOUT = (
    "Pairs are chosen by i-optimal before anything of the material is known: freely below 1134, of "
    "which smaller numbers are the first, then 81 views by 14 lights, then all. Values are the "
    "material's, without noise. nn and prior are gonio's; analytic is the best of sixteen models; "
    "paper is the recipe of Mikes and Haindl (2023) at 103,000 steps; pca-ridge is Nielsen et al. "
    "(2015) on a basis of generated materials, linear between the nodes of the grid; nbrdf is "
    "Sztrajman et al. (2021). Off grid are 100,000 random pairs up to 75 degrees of materials that "
    "are known there; compression is the numbers of the grid over those that a method keeps, where "
    "channels that are the same count once."
)


@click.command(name="shots")
@click.argument("materials", nargs=-1)
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), default=Path("study"), show_default=True,
    help="Folder of results; what it holds counts.",
)  # fmt: skip
@click.option("--shots", help="Numbers, with commas between.  [default: 8 to 6561]")
@click.option("--methods", help="Names, with commas between.  [default: all six]")
@click.option(
    "--generated",
    type=click.IntRange(0, 1000),
    default=0,
    help="Add so many generated anisotropic materials, scored between the grid's nodes, too.",
)
@answers
def command(
    *,
    materials: tuple[str, ...],
    output: Path,
    shots: str | None,
    methods: str | None,
    generated: int,
) -> None:
    """Compare methods of reconstruction on MATERIALS from few shots to all.

    \b
    Examples:
        gonio study shots wood-veneer --shots 16,64,196
        gonio study shots felt.npz silk.npz --methods nn,prior,paper
        gonio study shots --generated 10 --shots 196
    """  # noqa: D301
    from gonio.cli._console import console, progress_bar
    from gonio.cli._study import metric_notes, names_in, read_setting
    from gonio.cli._study_end import show_grids
    from gonio.errors import BadInputError
    from gonio.report.shots import shots_section
    from gonio.report.study import write_study
    from nnbrdf.studies import shots as study

    names = names_in(methods, study.METHODS, "method")
    counts = _counts(shots, study.COUNTS)
    if not materials and not generated:
        raise BadInputError("there is no material; name one, or give --generated 10")
    setting = read_setting(materials, output, "va-ia", seeds=1, epochs=1, steps=None)
    truths = [*setting.truths.values(), *(study.Drawn(seed).truth() for seed in range(generated))]
    table = output / "shots.csv"
    with progress_bar("reconstructing") as progress:
        results = study.run_shots(truths, _designs(counts), study.methods(names), table, progress)
    sections = [
        shots_section(truth.name, [s for s in results if s.sha256 == truth.digest])
        for truth in truths
    ]
    groups = {"": truths[: len(setting.truths)], "generated ": truths[len(setting.truths) :]}
    for kind, group in groups.items():
        if len(group) > 1:
            digests = {truth.digest for truth in group}
            of_group = [shot for shot in results if shot.sha256 in digests]
            title = f"Mean of {len(group)} {kind}materials"
            sections.insert(0, shots_section(title, of_group))
    page = output / "shots.html"
    times = "by the clock on the wall, from samples to values on the grid; other work adds to them"
    write_study(
        page, TITLE, ABOUT, sections, [("times", times), *metric_notes({t.name: t for t in truths})]
    )
    for section in sections:
        show_grids(section.title, section.grids)
    console.print(f"table: {table}")
    console.print(f"page:  {page}")
    answer({"page": page, "table": table, "results": [each.model_dump() for each in results]})


def _counts(text: str | None, default: tuple[int, ...]) -> tuple[int, ...]:
    from gonio.errors import BadInputError

    try:
        counts = default if text is None else tuple(sorted({int(each) for each in text.split(",")}))
    except ValueError:
        counts = ()
    if not counts or not all(8 <= count <= 6561 for count in counts):
        raise BadInputError(f"shots {text!r} are none; write numbers from 8 to 6561 like 16,64,196")
    return counts


def _designs(counts: tuple[int, ...]) -> dict[int, NDArray[np.int64]]:
    """Return the rows of the flattened 81 x 81 grid of each number of shots."""
    import numpy as np

    from nnbrdf.prior import MaterialPrior
    from planner.field import paper_field
    from planner.optimal import IOptimal

    field = paper_field()
    criterion = IOptimal(MaterialPrior.generate)
    designs = {}
    for count in counts:
        if count == 1134:
            choice = criterion.product(field, lights=14, views=81)
        else:
            choice = criterion.pairs(field, count)
        designs[count] = np.flatnonzero(choice.measured)
    return designs
