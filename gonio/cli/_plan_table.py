"""What a plan says in the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gonio.plan import Plan


def print_plan(plan: Plan) -> None:
    """Print what a plan takes, leaves out and costs."""
    from rich.table import Table

    from gonio.api.told import plan_rows
    from gonio.cli._console import console

    table = Table(show_header=False, box=None)
    for name, value in plan_rows(plan):
        table.add_row(name, value)
    console.print(table)
