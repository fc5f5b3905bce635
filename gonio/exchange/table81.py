"""The 81 x 81 table of gonio itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.exchange.format import Format, Source
from gonio.exchange.importing import read_npz
from gonio.materials import MeasuredTable

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.protocols import Progress


def write(source: Source, path: Path, progress: Progress | None) -> None:
    """Write an npz file of `values`, `directions` and `white`."""
    MeasuredTable(source.values, source.white).save(path)


FORMAT = Format(
    name="table",
    suffix=".npz",
    title="81 x 81 table of NumPy arrays, as gonio capture --sim --material reads it",
    keeps="every pair of the grid exactly, anisotropy, linear RGB, white",
    loses="what lies between the nodes and beyond 75 deg, sigma",
    write=write,
    read=read_npz,
    claims=lambda head, size: head.startswith(b"PK\x03\x04"),
)
