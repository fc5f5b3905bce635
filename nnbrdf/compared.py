"""What came of a comparison: `compare.csv`, an estimator a row."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from gonio.errors import BadFileError
from gonio.files import write_bytes
from gonio.validation import Document, check, read_text

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
        What the fit took.
    million_seconds
        What evaluating a million pairs takes.
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
    text = io.StringIO()
    writer = csv.DictWriter(text, list(Entry.model_fields), lineterminator="\n")
    writer.writeheader()
    for entry in entries:
        cells = entry.model_dump().items()
        writer.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in cells})
    write_bytes(folder / FILE_NAME, text.getvalue().encode())


def load_entries(folder: Path) -> list[Entry]:
    """Read `compare.csv` of a model's folder; none where nothing was compared.

    Raises
    ------
    gonio.errors.BadFileError
        When it is broken.
    """
    path = folder / FILE_NAME
    if not path.is_file():
        return []
    rows = csv.DictReader(read_text(path, _REMEDY).splitlines(), strict=True)
    try:
        return [check(Entry, row, path, _REMEDY) for row in rows]
    except csv.Error as error:
        raise BadFileError(path, f"is not CSV ({error})", _REMEDY) from None
