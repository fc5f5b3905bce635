"""`gonio compare`: materials held against each other, as a table and a page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.api.opened import Opened
    from gonio.report.versus import Versus

_SHAPES = ("sphere", "drape")
_SIZE_PX, _LIGHTS = 160, 96


@click.command(name="compare")
@click.argument("sources", nargs=-1, required=True, metavar="SESSION|MODEL|TABLE|NAME...")
@click.option(
    "--truth",
    metavar="SOURCE",
    help="What all are held against; of a simulated session, its truth.  [default: the first]",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    default=Path("compare.html"),
    show_default=True,
    help="The page.",
)
@answers
def command(*, sources: tuple[str, ...], truth: str | None, output: Path) -> None:
    """Hold materials against the first: errors, maps, lobes and renders.

    Each is a session's folder with a model, a model's folder, a file that gonio import reads, or a
    name that gonio materials shows. Printed are eps8 and male over the 81 x 81 pairs, the median
    and largest difference, and of a rendered sphere PSNR and the colour difference delta E 2000,
    this with pip install 'gonio[color]'.

    \b
    Examples:
        gonio compare satin monday/ tuesday/
        gonio compare monday/ monday/paper/ --truth monday/
        gonio compare old.npz new.npz --json | jq '.compared[].eps8'
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.errors import BadInputError
    from gonio.files import check_room

    check_room(output.parent)
    rows = _rows(sources, truth)
    if len(rows) < 2:
        raise BadInputError("one material alone is not compared; give a second, or --truth")
    reference, *others = rows
    found = _versus(reference, others)
    _write(output, rows, found)
    _show(output, reference, found)


def _rows(sources: Sequence[str], truth: str | None) -> list[Opened]:
    """Return the materials, the reference first."""
    from dataclasses import replace

    from gonio.api.opened import distinct, open_material, truth_in

    first = [] if truth is None else [replace(truth_in(truth), name="truth")]
    return distinct([*first, *map(open_material, sources)])


def _versus(reference: Opened, others: Sequence[Opened]) -> list[Versus]:
    from gonio.cli._console import progress_bar
    from gonio.report.versus import Versus
    from gonio.steps import Steps

    found = []
    with progress_bar("comparing") as progress:
        step = Steps(len(others), progress)
        for one in others:
            found.append(Versus.of(one.name, one.table, reference.table))
            step()
    return found


def _write(output: Path, rows: Sequence[Opened], found: Sequence[Versus]) -> None:
    from gonio.api.rendering import Scene
    from gonio.cli._console import progress_bar
    from gonio.report.compared_page import write_comparison

    scene = Scene.of(_SHAPES, "studio", _SIZE_PX, _LIGHTS)
    scores = {one.name: f"eps8 {one.eps8:.2f}, male {one.male:.3f}" for one in found}
    write_comparison(
        output,
        {one.name: one.material for one in rows},
        {one.name: one.table for one in rows},
        found,
        scene.sheet(rows, scores, 0.0, progress_bar),
    )


def _show(output: Path, reference: Opened, found: Sequence[Versus]) -> None:
    from gonio.cli._console import console
    from gonio.cli._study_end import show_grids
    from gonio.report.versus import documents, versus_grid

    show_grids("compare", [versus_grid(reference.name, found)])
    for one in found:
        pair = one.worst[0]
        console.print(
            f"{one.name}: furthest off by {pair.steps:.1f} steps, light at "
            f"{pair.light_theta_deg:g}, {pair.light_phi_deg:g} deg, view at "
            f"{pair.view_theta_deg:g}, {pair.view_phi_deg:g} deg"
        )
    console.print(f"page: {output}")
    answer({**documents(reference.name, reference.table.white, found), "page": output})
