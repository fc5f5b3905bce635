"""Direct light on a shape: all materials under the same lights, so that errors are their own."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.render.tabled import quick
from gonio.steps import Steps
from nnbrdf.cores import cores

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from gonio.protocols import Material, Progress
    from gonio.render.probe import Lights
    from gonio.render.shapes import Seen, Shape

    Array = NDArray[np.float64]

PLACES = ((0.125, 0.625), (0.375, 0.125), (0.625, 0.875), (0.875, 0.375))
"""Where in a pixel its four looks are, no two in one row or column."""
_LIGHTS_AT_ONCE = 4


@dataclass(frozen=True)
class Picture:
    """A material on a shape.

    Attributes
    ----------
    color
        Linear RGB before black, shape (size, size, 3); a perfect diffuser under a probe of 1 is 1.
    cover
        How much of each pixel the shape covers, 0 to 1, shape (size, size).
    """

    color: Array
    cover: Array


def shade(
    materials: Mapping[str, Material],
    shape: Shape,
    lights: Lights,
    size_px: int,
    progress: Progress | None = None,
) -> dict[str, Picture]:
    """Render materials on a shape by direct light, with the shape's own shadows.

    Each of the four looks through a pixel sees a quarter of the lights: antialiasing and area
    lights in one, as in `nnbrdf.sphere`. What is reflected twice is left out.

    Parameters
    ----------
    materials
        What it is made of, by name.
    shape
        One of `gonio.render.shapes.SHAPES`.
    lights
        At least 4 of them.
    size_px
        Side of the square pictures.
    progress
        Called with how much is done and how much there is.
    """
    seen = [shape.look(size_px, *place) for place in PLACES]
    chosen = [quick(material) for material in materials.values()]
    color = np.zeros((len(chosen), size_px**2, 3))
    tasks = [
        (seen[number], part)
        for number in range(len(PLACES))
        for part in _few_at_once(range(number, len(lights.direction), len(PLACES)))
    ]
    step = Steps(len(tasks), progress)
    with ThreadPoolExecutor(cores()) as pool:
        reflected = pool.map(lambda task: _reflect(chosen, task[0], lights, task[1]), tasks)
        # added in order, so that the number of threads does not change a bit
        for (look, _), light in zip(tasks, reflected, strict=True):
            color[:, look.pixel] += light
            step()
    cover = np.zeros(size_px**2)
    for look in seen:
        cover[look.pixel] += 1.0 / len(PLACES)
    square = (size_px, size_px)
    return {
        name: Picture(each.reshape(*square, 3), cover.reshape(square))
        for name, each in zip(materials, color, strict=True)
    }


def _few_at_once(indices: range) -> list[range]:
    return [indices[at : at + _LIGHTS_AT_ONCE] for at in range(0, len(indices), _LIGHTS_AT_ONCE)]


def _reflect(materials: list[Material], seen: Seen, lights: Lights, which: range) -> Array:
    """Return what materials send to the eye of some lights, shape (materials, n, 3)."""
    view = seen.frame[:, :, 2]
    total = np.zeros((len(materials), len(view), 3))
    for index in which:
        light = seen.frame @ lights.direction[index]
        weight = light[:, 2].clip(0.0) * seen.lit(lights.direction[index])
        rows = np.flatnonzero(weight > 0)
        power = weight[rows, None] * lights.power[index]
        for number, material in enumerate(materials):
            total[number, rows] += power * material.evaluate(light[rows], view[rows])
    return total
