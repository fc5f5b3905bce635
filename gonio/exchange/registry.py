"""The formats by name; each is a module that is imported where it is used."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Final

from gonio.errors import BadFileError, BadInputError
from gonio.exchange.limits import head_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from gonio.exchange.format import Format

TABLE: Final = "table"
"""The name of gonio's own."""

FORMATS: Final = {
    TABLE: "gonio.exchange.table81",
    "csv": "gonio.exchange.plain_csv",
    "rgl": "gonio.exchange.rgl",
    "merl": "gonio.exchange.merl",
    "utia": "gonio.exchange.utia",
    "klems": "gonio.exchange.klems",
    "tensortree": "gonio.exchange.tensor_tree",
    "onnx": "gonio.exchange.networks.onnx_graph",
    "glsl": "gonio.exchange.networks.glsl",
    "c": "gonio.exchange.networks.c_header",
    "mitsuba": "gonio.exchange.networks.mitsuba_plugin",
}
"""Modules by the name of their format, in the order in which they are listed; each has a FORMAT."""


def format_named(name: str) -> Format:
    """Return a format.

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown name; the message lists the known ones.
    """
    if name not in FORMATS:
        raise BadInputError(f"format {name!r} is not known; use {', '.join(FORMATS)}")
    found: Format = import_module(FORMATS[name]).FORMAT
    return found


def formats() -> Iterator[Format]:
    """Yield all formats in the order in which they are listed."""
    yield from map(format_named, FORMATS)


def format_of_file(path: Path) -> Format:
    """Tell a file's format by its content, and where that does not tell by the end of its name.

    Raises
    ------
    gonio.errors.BadFileError
        When the file is missing or of no format that gonio reads.
    """
    head, size = head_of(path)
    readable = [each for each in formats() if each.read is not None]
    for each in readable:
        if each.claims is not None and each.claims(head, size):
            return each
    for each in readable:
        if path.suffix.lower() == each.suffix:
            return each
    raise BadFileError(path, "is of no known format", f"gonio reads {_names(readable)}")


def _names(known: Iterable[Format]) -> str:
    return ", ".join(f"{each.name} ({each.suffix})" for each in known)
