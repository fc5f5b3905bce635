"""The formats of other programs in the help of the commands that write and read them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from gonio.exchange import Format


class ListingFormats(click.Command):
    """A command whose help ends with what each format keeps and loses.

    Parameters
    ----------
    writing
        Whether it lists what gonio writes, or what it reads.
    """

    def __init__(self, *args: object, writing: bool, **kwargs: object) -> None:
        super().__init__(*args, **kwargs)  # type: ignore[arg-type]
        self._writing = writing

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list."""
        from gonio.exchange.importing import imported_formats
        from gonio.exchange.registry import formats

        written = [each for each in formats() if each.write is not None]
        known = written if self._writing else imported_formats()
        with formatter.section("Formats"):
            formatter.write_dl([(each.name, _said(each)) for each in known])


def _said(format_: Format) -> str:
    title = f"{format_.title} ({format_.suffix})"
    return f"{title}. Keeps {format_.keeps}. Loses {format_.loses}."
