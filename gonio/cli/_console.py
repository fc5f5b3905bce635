"""What the commands share in talking to a person: progress bars and tables."""

from __future__ import annotations

from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from gonio.words import duration

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.protocols import Progress as Report

_LINE_EVERY_S = 30.0

console = Console(highlight=False, soft_wrap=True)


@contextmanager
def progress_bar(title: str) -> Iterator[Report]:
    """Show a bar with the time left; yields what to call with (done, total).

    Off a terminal, in a log, it is a line every half minute.
    """
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    screen = Console(stderr=True)
    if not screen.is_terminal:
        yield _lines(title, screen)
        return
    with Progress(*columns, console=screen) as bar:
        task = bar.add_task(title, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def _lines(title: str, screen: Console) -> Report:
    began = last = monotonic()

    def report(done: int, total: int) -> None:
        nonlocal last
        now = monotonic()
        if now - last >= _LINE_EVERY_S:
            last = now
            screen.print(f"{title}: {done} of {total} after {duration(now - began)}")

    return report


def note(text: str) -> None:
    """Tell a person what does not keep the work from going on."""
    # not on standard error, where an error stays the one line that there is
    console.print(f"note: {text}", markup=False)
