"""Tables of results as CSV: a row a document, checked when it is read."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

from gonio.errors import BadFileError
from gonio.files import write_bytes
from gonio.validation import D, check, read_text

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path


def write_rows(path: Path, model: type[D], rows: Iterable[D]) -> None:
    """Write one line a row, whole or not at all; None is an empty cell.

    Raises
    ------
    gonio.errors.StorageError
        When the operating system refuses.
    """
    text = io.StringIO()
    writer = csv.DictWriter(text, list(model.model_fields), lineterminator="\n")
    writer.writeheader()
    writer.writerows(row.model_dump() for row in rows)
    write_bytes(path, text.getvalue().encode())


def read_rows(path: Path, model: type[D], remedy: str) -> list[D]:
    """Read what `write_rows` wrote; nothing where there is no file.

    Raises
    ------
    gonio.errors.BadFileError
        When it is broken, or a row does not fit the model.
    """
    if not path.exists():
        return []
    table = csv.DictReader(read_text(path, remedy).splitlines(), strict=True)
    try:
        for name in model.model_fields:
            if name not in (table.fieldnames or ()):
                raise BadFileError(path, f"{name}: is missing", remedy)
        rows = [{name: cell for name, cell in row.items() if cell != ""} for row in table]
    except csv.Error as error:
        raise BadFileError(path, f"is not CSV ({error})", remedy) from None
    return [check(model, row, path, remedy) for row in rows]
