"""What the checks of a reduction say in the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gonio.session import Session


def tell_checks(session: Session) -> None:
    """Print a line for each check, and how to take again what failed."""
    from rich.markup import escape
    from rich.table import Table

    from gonio.checks import Checks
    from gonio.cli._console import console
    from gonio.words import several

    checks = Checks.load(session.checks_path)
    # [lamps] names a part of a file, and no style
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    for each in checks.checks:
        table.add_row(each.verdict, each.name, escape(each.line))
    console.print(table)
    if checks.suspects:
        count = several(len(checks.suspects), "shot")
        console.print(f"take {count} again with: {session.retake_command}")
