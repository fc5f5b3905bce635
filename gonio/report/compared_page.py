"""The page of materials held against each other."""

from __future__ import annotations

import base64
import io
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup, escape

from gonio.report import maps
from gonio.report.drawings import Drawing
from gonio.report.figures import inline_svg, page_style
from gonio.report.grids import Section, identifier
from gonio.report.lobes import draw_lobes
from gonio.report.study import write_study
from gonio.report.versus import versus_grid, worst_grid

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from matplotlib.figure import Figure

    from gonio.materials import MeasuredTable
    from gonio.protocols import Material
    from gonio.report.render_sheet import Sheet
    from gonio.report.versus import Versus

_PLANES = ((0.0, "Lobes along the marked edge"), (90.0, "Lobes across the marked edge"))
_SHEET_DPI = 110
_NOTES = (
    ("eps8", "mean absolute error on an 8-bit scale that ends at white, as the paper's"),
    ("male", "mean absolute error of the natural logarithm, above a floor of 1 % of white"),
    ("delta E 2000", "mean over the pixels of two pictures of a sphere; needs gonio[color]"),
    ("steps", "of 255, the mean of the channels' absolute difference, both clipped at white"),
)


def write_comparison(
    target: Path,
    materials: Mapping[str, Material],
    tables: Mapping[str, MeasuredTable],
    rows: Sequence[Versus],
    sheet: Sheet,
) -> None:
    """Write the page, self-contained, whole or not at all.

    Parameters
    ----------
    target
        Where to.
    materials, tables
        By name, the reference first; a table is a material on the 81 x 81 grid.
    rows
        All but the reference, held against it.
    sheet
        Their renders.

    Raises
    ------
    gonio.errors.StorageError
        When it cannot be written.
    """
    reference, table = next(iter(tables.items()))
    with page_style():
        renders = Drawing("Renders", _png(sheet.draw(), "renders"), "One light, one exposure.")
        planes = tuple(_lobes(materials, table.white))
        pictures = tuple(_maps(tables))
    sections = (
        Section("Errors", (), (versus_grid(reference, rows),)),
        Section("Renders", (renders,), (), broad=True),
        Section("Lobes", planes, (), broad=True),
        Section("Maps", pictures, ()),
        Section("Where they differ most", (), tuple(worst_grid(row) for row in rows)),
    )
    about = (
        f"Held against {reference}, whose white, {table.white:.3g} 1/sr, is that of all. "
        "Maps show the 81 x 81 pairs, light by view."
    )
    title = ", ".join(tables)
    write_study(target, title, about, sections, _NOTES, eyebrow="gonio compare")


def _lobes(materials: Mapping[str, Material], white: float) -> Iterator[Drawing]:
    for azimuth_deg, title in _PLANES:
        figure = draw_lobes(azimuth_deg, materials, white)
        caption = (
            f"Plane of incidence at φ = {azimuth_deg:g}°; dashed: what the others are held to."
        )
        yield _drawing(title, figure, caption)


def _maps(tables: Mapping[str, MeasuredTable]) -> Iterator[Drawing]:
    reference, true = next(iter(tables.items()))
    white = true.white
    for name, table in tables.items():
        caption = f"White is {white:.3g} 1/sr, then sRGB."
        yield _drawing(name, maps.draw_map(table.values, white), caption)
        if name == reference:
            continue
        difference = np.abs(table.values.clip(0.0, white) - true.values.clip(max=white))
        factor = maps.enlargement(difference, white)
        yield _drawing(
            f"{name} - {reference}, × {factor}",
            maps.draw_map(factor * difference, white),
            f"Absolute, both clipped at white as eps8 does, enlarged {factor} times.",
        )


def _drawing(title: str, figure: Figure, caption: str) -> Drawing:
    return Drawing(title, inline_svg(figure, identifier(title), f"{title}: {caption}"), caption)


def _png(figure: Figure, label: str) -> Markup:
    """Return a figure of many pixels as an image element; as SVG it would be as large again."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=_SHEET_DPI, facecolor="white")
    data = base64.b64encode(buffer.getvalue()).decode()
    style = "width: 100%; height: auto; display: block"
    return Markup(f'<img src="data:image/png;base64,{data}" alt="{escape(label)}" style="{style}">')
