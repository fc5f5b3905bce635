"""The truth that only the twin knows: its material on the 81 x 81 grid."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.directions import paper_directions
from gonio.materials import MeasuredTable

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.protocols import Material


def write_truth(path: Path, material: Material) -> None:
    """Write the material's values at the 81 x 81 pairs as an npz table, whole or not at all.

    A measured table keeps its own white; any other material gets 4 x its median.

    Raises
    ------
    gonio.errors.StorageError
        When the file cannot be written.
    """
    if not isinstance(material, MeasuredTable):
        directions = paper_directions()
        material = MeasuredTable.of(material.evaluate(directions[:, None], directions))
    material.save(path)
