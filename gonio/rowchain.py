"""The chain of a journal's rows: each states a SHA-256 of itself and of the one before it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

from gonio.files import canonical_json, sha256_bytes

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

START: Final = ""
"""What stands for the hash before the first row."""


class Row(NamedTuple):
    """A row as the file holds it, whatever that is; `sha256` is None in a journal of before."""

    number: Any
    at_s: Any
    utc: Any
    kind: Any
    data: Any
    sha256: Any = None


def row_sha256(previous: str, row: Row) -> str:
    """Return the hash that a row has to state, after one that states `previous`.

    It is the SHA-256 of the canonical JSON of [previous, number, at_s, utc, kind, data]; empty for
    what no journal ever wrote.
    """
    try:
        return sha256_bytes(canonical_json([previous, *row[:5]]))
    except (TypeError, ValueError):  # bytes, or an infinity
        return ""


def followed(rows: Iterable[Row]) -> Iterator[tuple[Row, str]]:
    """Iterate over rows, each with the hash that it has to state."""
    previous = START
    for row in rows:
        due = row_sha256(previous, row)
        yield row, due
        previous = due if row.sha256 is None else str(row.sha256)


def break_in(rows: Iterable[Row], written: int) -> str | None:
    """Return what is wrong with the first row that breaks the chain; None where it is whole.

    Parameters
    ----------
    rows
        In the order of their numbers. The first of them may state no hash, as in a journal that
        was begun before there were any; the next that does vouches for them.
    written
        How many there were ever.
    """
    count, is_chained = 0, False
    for count, (row, due) in enumerate(followed(rows), start=1):
        if row.number != count:
            return f"record {count} is missing"
        is_chained = is_chained or row.sha256 is not None
        if is_chained and row.sha256 != due:
            return f"record {count} is not the one that was written there"
    return None if count >= written else f"record {count + 1} is missing"
