"""A page of materials side by side, as PNG."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.files import write_with
from nnbrdf.sphere import shade_sphere, sphere_cover, tone_map

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gonio.protocols import Material

_COLUMNS = 3
_SPHERE_PX = 180
_DPI = 100


def write_contact_sheet(path: Path, materials: Mapping[str, Material]) -> None:
    """Draw each material on a sphere with its name below; write PNG, whole or not at all.

    Raises
    ------
    gonio.errors.StorageError
        When the file cannot be written.
    """
    # drawn inside, so that a path that cannot be written fails before the seconds that it takes
    write_with(path, lambda aside: _figure(materials).savefig(aside, format="png"))


def _figure(materials: Mapping[str, Material]) -> Figure:
    from matplotlib.figure import Figure

    rows = -(-len(materials) // _COLUMNS)
    figure = Figure(figsize=(2.6 * _COLUMNS, 2.6 * rows), dpi=_DPI, layout="constrained")
    axes = figure.subplots(rows, _COLUMNS, squeeze=False).ravel()
    for axis in axes:
        axis.set_axis_off()
    for axis, (name, material) in zip(axes, materials.items(), strict=False):
        axis.imshow(_picture(material))
        axis.set_title(name, y=-0.12)
    return figure


def _picture(material: Material) -> NDArray[np.float64]:
    """Return the sphere in sRGB on white paper, 0 to 1, shape (size, size, 3)."""
    sphere = tone_map(shade_sphere(material, _SPHERE_PX)) / 255.0
    return np.clip(sphere + 1.0 - sphere_cover(_SPHERE_PX)[..., None], 0.0, 1.0)
