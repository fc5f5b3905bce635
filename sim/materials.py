"""The materials that the twin can carry: embedded by name, or a measured table from a file."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import paper_directions
from gonio.errors import BadInputError
from gonio.exchange import read_material
from nnbrdf.analytic import (
    AnisotropicGGX,
    CoatedDiffuse,
    Fibers,
    Lambert,
    OrenNayar,
    Rotated,
    Sheen,
    Sum,
)
from sim.board import CharucoBoard
from sim.chart import ColorChart

if TYPE_CHECKING:
    from gonio.protocols import Material


@dataclass(frozen=True)
class Embedded:
    """A material that comes with gonio.

    Attributes
    ----------
    description
        One line.
    material
        Its reflectance, linear sRGB.
    """

    description: str
    material: Material


EMBEDDED: dict[str, Embedded] = {
    "wood-veneer": Embedded(
        "varnished wood, grain along +x, fibers tilted",
        Sum(
            (
                CoatedDiffuse((0.30, 0.13, 0.045), 0.04),
                Fibers((0.085, 0.045, 0.018), width=radians(11), tilt=radians(10)),
                AnisotropicGGX((0.04, 0.04, 0.04), 0.18, 0.26),
            )
        ),
    ),
    "woven-cloth": Embedded(
        "matte weave, blue warp along +x, gold weft",
        Sum(
            (
                OrenNayar((0.10, 0.10, 0.13), 0.8),
                Fibers((0.010, 0.025, 0.10), width=radians(15)),
                Fibers((0.10, 0.052, 0.010), width=radians(15), phi=radians(90)),
                Sheen((0.10, 0.10, 0.12), 0.4),
            )
        ),
    ),
    "brushed-metal": Embedded(
        "aluminium with fine grooves along +x",
        Sum(
            (
                AnisotropicGGX((0.86, 0.87, 0.88), 0.07, 0.38),
                Lambert((0.02, 0.02, 0.02)),
            )
        ),
    ),
    "satin": Embedded(
        "rose satin, long floats along +x, broad sheen",
        Sum(
            (
                OrenNayar((0.30, 0.07, 0.09), 0.3),
                AnisotropicGGX((0.20, 0.11, 0.12), 0.20, 0.50),
                Fibers((0.10, 0.045, 0.05), width=radians(14), tilt=radians(4)),
            )
        ),
    ),
    "matte-paint": Embedded(
        "chalky wall paint, warm white, no highlight",
        OrenNayar((0.72, 0.66, 0.55), 0.6),
    ),
    "near-mirror": Embedded(
        "black glass, dark but for one narrow highlight",
        Sum(
            (
                AnisotropicGGX((0.05, 0.05, 0.05), 0.03, 0.03),
                CoatedDiffuse((0.010, 0.010, 0.012), 0.05),
            )
        ),
    ),
    "velvet": Embedded(
        "purple pile, dark from above, bright at the rim",
        Sum(
            (
                OrenNayar((0.045, 0.008, 0.055), 1.0),
                Sheen((0.26, 0.09, 0.30), 0.25),
            )
        ),
    ),
    "glossy-plastic": Embedded(
        "green plastic with a small, clear highlight",
        Sum(
            (
                CoatedDiffuse((0.03, 0.34, 0.08), 0.045),
                AnisotropicGGX((0.045, 0.045, 0.045), 0.10, 0.10),
            )
        ),
    ),
    "gold-leaf": Embedded(
        "gilded surface, evenly rough metal",
        Sum(
            (
                AnisotropicGGX((1.00, 0.71, 0.29), 0.30, 0.30),
                Lambert((0.010, 0.007, 0.003)),
            )
        ),
    ),
    "charuco": Embedded(
        "the holder's ChArUco board, uncut",
        CharucoBoard(),
    ),
    "colorchecker": Embedded(
        "a chart of 24 patches, for gonio color",
        ColorChart(),
    ),
}
"""By name, in the order in which they are listed."""


def load_material(name_or_path: str) -> Material:
    """Return an embedded material by name, or that of a file that gonio reads.

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown name; the message lists the known ones.
    gonio.errors.BadFileError
        When the file is missing, or none that gonio reads.
    """
    if name_or_path in EMBEDDED:
        return EMBEDDED[name_or_path].material
    if Path(name_or_path).suffix:
        return read_material(Path(name_or_path))
    raise BadInputError(
        f"material {name_or_path!r} is not known; use {', '.join(EMBEDDED)}, "
        "or the path of an .npz table, or of a file that gonio import reads (gonio materials shows "
        "them)"
    )


def anisotropy(material: Material) -> float:
    """Return how much the material changes when it is turned, from 0 (isotropic) to 1.

    The mean absolute change over the 81 x 81 pairs for a turn by 45 or 90 deg, whichever changes
    more, relative to the sum of both means.
    """
    light, view = paper_directions()[:, None], paper_directions()
    value = material.evaluate(light, view)
    changes = []
    for turn in (45, 90):
        turned = Rotated(material, radians(turn)).evaluate(light, view)
        changes.append(np.abs(turned - value).mean() / (turned + value).mean())
    return float(max(changes))
