"""What came of a comparison: `compare.csv`, an estimator a row."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from gonio.validation import Document
from nnbrdf.rows import read_rows, write_rows

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

FILE_NAME = "compare.csv"
DEFAULT, GENERAL = "nn", "nn --general"
"""Entries of the default estimator, and of the same with nothing left out by evidence."""
_REMEDY = "make it again with: gonio reconstruct --compare"

Against = Literal["truth", "held out"]
Positive = Annotated[float, Field(gt=0)]
Error = Annotated[float, Field(ge=0)]


class Entry(Document):
    """One row of `compare.csv`.

    Attributes
    ----------
    name
        Of the estimator, with its size or how long it was trained.
    weights
        How many numbers its model is made of.
    fit_seconds
        What the fit took by the clock on the wall, on all cores.
    million_seconds
        What evaluating a million pairs takes of the processor, on one core.
    eps8, male
        Of the model, see `nnbrdf.metrics`.
    against
        What the errors are held against.
    """

    name: str
    weights: Annotated[int, Field(ge=1)]
    fit_seconds: Positive
    million_seconds: Positive
    eps8: Error
    male: Error
    against: Against


def save_entries(folder: Path, entries: Iterable[Entry]) -> None:
    """Write `compare.csv` beside a model, which takes it along when it is replaced.

    Raises
    ------
    gonio.errors.StorageError
        When the operating system refuses.
    """
    write_rows(folder / FILE_NAME, Entry, entries)


def load_entries(folder: Path) -> list[Entry]:
    """Read `compare.csv` of a model's folder; none where nothing was compared.

    Raises
    ------
    gonio.errors.BadFileError
        When it is broken.
    """
    return read_rows(folder / FILE_NAME, Entry, _REMEDY)
