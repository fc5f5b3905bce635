"""The materials that the twin can carry: embedded by name, or a measured table from a file."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians
from typing import TYPE_CHECKING

from gonio.errors import BadInputError
from gonio.materials import MeasuredTable
from nnbrdf.analytic import (
    AnisotropicGGX,
    CoatedDiffuse,
    Fibers,
    Lambert,
    OrenNayar,
    Sheen,
    Sum,
)

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
        "varnished wood, grain along +x, its fibers tilted out of the surface",
        Sum(
            (
                CoatedDiffuse((0.30, 0.13, 0.045), 0.04),
                Fibers((0.085, 0.045, 0.018), width=radians(11), tilt=radians(10)),
                AnisotropicGGX((0.04, 0.04, 0.04), 0.18, 0.26),
            )
        ),
    ),
    "woven-cloth": Embedded(
        "two-colored weave, blue warp along +x and gold weft, with a soft bloom",
        Sum(
            (
                OrenNayar((0.075, 0.085, 0.11), 0.5),
                Fibers((0.012, 0.030, 0.12), width=radians(9)),
                Fibers((0.12, 0.065, 0.010), width=radians(9), phi=radians(90)),
                Sheen((0.06, 0.06, 0.07), 0.4),
            )
        ),
    ),
    "brushed-metal": Embedded(
        "aluminium brushed along +x, its highlight drawn out across the grooves",
        Sum(
            (
                AnisotropicGGX((0.86, 0.87, 0.88), 0.07, 0.38),
                Lambert((0.02, 0.02, 0.02)),
            )
        ),
    ),
    "satin": Embedded(
        "rose satin, long floats of warp along +x with a soft, broad sheen",
        Sum(
            (
                OrenNayar((0.30, 0.07, 0.09), 0.3),
                AnisotropicGGX((0.20, 0.11, 0.12), 0.20, 0.50),
                Fibers((0.10, 0.045, 0.05), width=radians(14), tilt=radians(4)),
            )
        ),
    ),
    "matte-paint": Embedded(
        "chalky wall paint, warm white, almost without a highlight",
        OrenNayar((0.72, 0.66, 0.55), 0.6),
    ),
    "near-mirror": Embedded(
        "black glass, dark but for one very narrow highlight",
        Sum(
            (
                AnisotropicGGX((0.05, 0.05, 0.05), 0.03, 0.03),
                CoatedDiffuse((0.010, 0.010, 0.012), 0.05),
            )
        ),
    ),
    "velvet": Embedded(
        "deep purple pile, dark from above and glowing at the rim",
        Sum(
            (
                OrenNayar((0.045, 0.008, 0.055), 1.0),
                Sheen((0.26, 0.09, 0.30), 0.25),
            )
        ),
    ),
    "glossy-plastic": Embedded(
        "green injection-molded plastic with a small clear highlight",
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
}
"""By name, in the order in which they are listed."""


def load_material(name_or_path: str) -> Material:
    """Return an embedded material by name, or a measured table from an npz file.

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown name; the message lists the known ones.
    gonio.errors.BadFileError
        When the file is missing or is no table.
    """
    if name_or_path in EMBEDDED:
        return EMBEDDED[name_or_path].material
    if name_or_path.endswith(".npz"):
        return MeasuredTable.load(name_or_path)
    raise BadInputError(
        f"material {name_or_path!r} is not known; use {', '.join(EMBEDDED)}, "
        "or the path of an .npz table (gonio materials shows them)"
    )
