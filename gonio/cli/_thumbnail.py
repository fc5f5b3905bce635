"""A material as a small picture in the terminal: half blocks in true color."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.style import Style
from rich.text import Text

from nnbrdf.sphere import shade_sphere, sphere_cover, tone_map

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gonio.protocols import Material

SIZE_PX = 12


def thumbnail(material: Material) -> Text:
    """Return the material's sphere, 12 columns by 6 rows, on the terminal's own background."""
    cover = sphere_cover(SIZE_PX)
    visible = cover > 0.4
    color = tone_map(shade_sphere(material, SIZE_PX) / cover.clip(0.1)[..., None])
    lines = [
        Text.assemble(*map(_cell, color[row : row + 2].swapaxes(0, 1), visible[row : row + 2].T))
        for row in range(0, SIZE_PX, 2)
    ]
    return Text("\n").join(lines)


def _cell(color: NDArray[np.uint8], visible: NDArray[np.bool_]) -> tuple[str, Style]:
    """Return the character that shows two pixels, one above the other."""
    upper, lower = (
        "rgb({},{},{})".format(*pixel) if shown else None
        for pixel, shown in zip(color, visible, strict=True)
    )
    if upper is None:
        return ("▄" if lower else " "), Style(color=lower)
    return "▀", Style(color=upper, bgcolor=lower)
