"""Formats that hold the network itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.exchange.format import Format
from gonio.exchange.networks.portable import portable_of
from gonio.files import write_bytes

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from gonio.exchange.format import Source
    from gonio.exchange.networks.portable import Portable
    from gonio.protocols import Progress


def network_format(
    name: str, suffix: str, title: str, content: Callable[[Portable, Source, Path], bytes]
) -> Format:
    """Return a format of one file with the network inside.

    Parameters
    ----------
    name, suffix, title
        As of `gonio.exchange.format.Format`.
    content
        Of the file, from the network, what is exported, and the file's path.
    """

    def write(source: Source, path: Path, progress: Progress | None) -> None:
        """Write the file; a material that is no network is refused (`BadInputError`)."""
        write_bytes(path, content(portable_of(source.material, source.name), source, path))

    return Format(
        name=name,
        suffix=suffix,
        title=title,
        keeps="the network in single precision, every pair of directions, anisotropy",
        loses="sigma",
        write=write,
        read=None,
    )
