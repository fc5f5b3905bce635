"""A material on shapes, as pictures within the page."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.color import InSpace
from gonio.render import PROBES, SHAPES, shade
from gonio.render.contrast import contrast, developed, exposure
from gonio.report.images import png_uri

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from gonio.materials import MeasuredTable
    from gonio.protocols import Material
    from gonio.render import Picture
    from gonio.report.screen import Screen

_SIZE_PX, _LIGHTS = 144, 32
_SHAPES = ("sphere", "drape")
_PROBE = "studio"
ABOUT = (
    f"Under {PROBES[_PROBE].description}; direct light alone. Larger, on more shapes and beside "
    "other recipes: gonio render."
)


class Render(NamedTuple):
    """A picture of a material on a shape, and how far it is from that of the truth."""

    shape: str
    material: str
    uri: str
    note: str


def renders_of(
    model: Material,
    truth: MeasuredTable | None,
    screen: Screen,
    shapes: Sequence[str] = (),
) -> list[Render]:
    """Render a model on each shape (those of the page), beside it the truth where it is known."""
    materials = {"reconstruction": model}
    if truth is not None:
        materials["truth"] = truth
    if not np.array_equal(screen.matrix, np.eye(3)):
        materials = {name: InSpace(each, screen.matrix) for name, each in materials.items()}
    lights = PROBES[_PROBE].lights(_LIGHTS)
    shaded = {name: shade(materials, SHAPES[name], lights, _SIZE_PX) for name in shapes or _SHAPES}
    # all in one exposure, the truth's where it is known
    factor = exposure(list(pictures.values())[-1] for pictures in shaded.values())
    return [
        Render(shape, material, _uri(picture, factor), _note(material, pictures, factor))
        for shape, pictures in shaded.items()
        for material, picture in pictures.items()
    ]


def _uri(picture: Picture, factor: float) -> str:
    whole = replace(picture, color=picture.color / picture.cover.clip(0.25)[..., None])
    alpha = np.round(255.0 * picture.cover).astype(np.uint8)
    return png_uri(np.dstack([developed(whole, factor), alpha]))


def _note(material: str, pictures: Mapping[str, Picture], factor: float) -> str:
    if material == "truth" or "truth" not in pictures:
        return ""
    return f"PSNR {contrast(pictures[material], pictures['truth'], factor).psnr}"
