"""`gonio render`: materials on shapes under a probe of light, beside each other."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gonio.api.numbers import LIGHTS, SIZE_PX, STOPS
from gonio.cli._json import answer, answers
from gonio.cli._numbers import FiniteRange

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.api.opened import Opened
    from gonio.api.rendering import Scene
    from gonio.report.render_sheet import Sheet

_SHAPES = ("sphere", "drape", "panel")
_PROBES = ("studio", "sky", "furnace")
_RENDERERS = ("auto", "own", "mitsuba")
_RECIPES = ("paper", "analytic", "nbrdf")
SHEET_NAME = "render.png"


@click.command(name="render")
@click.argument("sources", nargs=-1, metavar="[SESSION|MODEL|TABLE|NAME]...")
@click.option(
    "-o",
    "--output",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("render"),
    show_default=True,
    help="Folder of the pictures.",
)
@click.option(
    "--truth",
    metavar="SOURCE",
    help="What the others are held against.  [default: the truth of a simulated session, else the "
    "first]",
)
@click.option(
    "--beside",
    "recipes",
    type=click.Choice(_RECIPES, case_sensitive=False),
    multiple=True,
    help="Also fit this to the session's samples: paper (Mikes and Haindl 2023), analytic (the "
    "model of the literature that fits best), nbrdf (Sztrajman et al. 2021); may be repeated.  "
    "[default: paper, where there is a session]",
)
@click.option(
    "--activations",
    metavar="NAME,...",
    help="Also networks of the paper's recipe with these: relu,hardshrink,tanh ... (any other word "
    "lists all twenty). Those that are not smooth show as facets and edges.",
)
@click.option(
    "--shape",
    "shapes",
    type=click.Choice(_SHAPES, case_sensitive=False),
    multiple=True,
    help="A sphere, cloth in folds, a car's wing; may be repeated.  [default: all three]",
)
@click.option(
    "--probe",
    type=click.Choice(_PROBES, case_sensitive=False),
    default="studio",
    show_default=True,
    help="Softbox and strip light; sky with a sun; or 1 from everywhere.",
)
@click.option(
    "--size",
    type=click.IntRange(*SIZE_PX),
    default=256,
    show_default=True,
    help="Side of each picture in pixels.",
)
@click.option(
    "--lights",
    type=click.IntRange(*LIGHTS),
    default=192,
    show_default=True,
    help="Directions that stand for the probe: more for glossy materials. Mitsuba follows a "
    "sixth as many paths a pixel.",
)
@click.option(
    "--stops",
    type=FiniteRange(*STOPS),
    default=0.0,
    help="Brighter by so many doublings; 0 makes the mean of the first 18 %.",
)
@click.option(
    "--renderer",
    type=click.Choice(_RENDERERS, case_sensitive=False),
    default="auto",
    show_default=True,
    help="Mitsuba 3, where it is installed, with light that is reflected more than once; or our "
    "own, with direct light alone.",
)
@answers
def command(
    *, sources: tuple[str, ...], output: Path, truth: str | None, recipes: tuple[str, ...],
    activations: str | None, shapes: tuple[str, ...], probe: str, size: int,
    lights: int, stops: float, renderer: str,
) -> None:  # fmt: skip
    """Show materials as people see them, and where they differ.

    A source is a session's folder with a model, a model's folder, a file that gonio import
    reads, or a name that gonio materials shows.  [default: session]

    A row of render.png is a material: on each shape under the probe, and beside it the difference
    from the first row. All have the same lights and the same exposure, so what differs is the
    material. Linear pictures are beside it as EXR, the probe too.

    \b
    Examples:
        gonio render session/
        gonio render session/ --beside paper --beside analytic
        gonio render session/ --activations relu,hardshrink,tanh
        gonio render wood-veneer brushed-metal --probe sky --size 512
        gonio render --truth measured.npz model/ older/model/ --shape sphere
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.api.beside import fitted_beside, score_line
    from gonio.api.opened import distinct, open_material
    from gonio.api.rendering import Scene
    from gonio.cli._console import console, progress_bar
    from gonio.files import check_room
    from gonio.render.renderers import chosen

    check_room(output)
    used = chosen(renderer)
    scene = Scene.of(shapes or _SHAPES, probe, size, lights, used.name)
    opened = [open_material(source) for source in sources or ("session",)]
    if not recipes and any(one.samples is not None for one in opened):
        recipes = ("paper",)
    names = _activations(activations)
    fitted = fitted_beside(opened, recipes, names, progress_bar)
    rows = distinct([*_reference(opened, truth), *opened, *fitted])
    scores = {one.name: score_line(one, rows[0]) for one in rows[1:]}
    sheet = scene.sheet(rows, scores, stops, progress_bar)
    _write(output, sheet, scene)
    console.print(str(used), markup=False)
    for line in _lines(sheet):
        console.print(line)
    console.print(f"pictures: {output / SHEET_NAME}, linear ones beside it (*.exr)")
    pictures = output / SHEET_NAME
    answer({"pictures": pictures, "renderer": used.name, "rendered": _document(sheet)})


def _activations(text: str | None) -> Sequence[str]:
    from gonio.cli._study import names_in
    from nnbrdf.activations import ACTIVATIONS

    return names_in(text, list(ACTIVATIONS), "activation") if text else ()


def _reference(opened: Sequence[Opened], truth: str | None) -> list[Opened]:
    """Return what comes first: what was asked for, or the truth of the first that has one."""
    from dataclasses import replace

    from gonio.api.opened import truth_in

    if truth is not None:
        return [replace(truth_in(truth), name="truth")]
    return [one.truth for one in opened if one.truth is not None][:1]


def _write(folder: Path, sheet: Sheet, scene: Scene) -> None:
    import numpy as np

    from gonio.render.exr import write_exr
    from gonio.report.grids import identifier
    from gonio.words import told_apart

    names = told_apart([identifier(name) for name in sheet.pictures], "{}-{}")
    for name, of_shape in zip(names, sheet.pictures.values(), strict=True):
        for shape, picture in of_shape.items():
            alpha = picture.cover[..., None]
            linear = np.concatenate([picture.color, alpha], axis=-1)
            write_exr(folder / f"{name}-{shape}.exr", linear)
    write_exr(folder / "probe.exr", scene.probe.panorama())
    sheet.write(folder / SHEET_NAME)


def _document(sheet: Sheet) -> list[dict[str, Any]]:
    return [
        {
            "name": name,
            "scores": sheet.scores.get(name),
            "by_shape": {
                shape: {"psnr_db": each.psnr_db, "mean_steps": each.mean}
                for shape, each in sheet.contrasts.get(name, {}).items()
            },
        }
        for name in sheet.pictures
    ]


def _lines(sheet: Sheet) -> list[str]:
    """Say what each picture's difference is."""
    return [
        f"{name}: {sheet.scores[name]}; PSNR "
        + ", ".join(f"{shape} {each.psnr}" for shape, each in of_shape.items())
        for name, of_shape in sheet.contrasts.items()
    ]
