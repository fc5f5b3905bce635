"""Materials to and from files of other programs, one file a format (docs/topics/exchange.md)."""

from gonio.exchange.exporting import Exported, export
from gonio.exchange.format import Format, Source
from gonio.exchange.importing import import_file, read_material
from gonio.exchange.registry import FORMATS, format_named, format_of_file
from gonio.exchange.source import source_of, source_of_session

__all__ = [
    "FORMATS",
    "Exported",
    "Format",
    "Source",
    "export",
    "format_named",
    "format_of_file",
    "import_file",
    "read_material",
    "source_of",
    "source_of_session",
]
