"""One line on the terminal about what a served twin does."""

from __future__ import annotations

from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING

from rich.console import Console
from rich.live import Live
from rich.text import Text

from gonio.words import duration, several

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from sim.served.server import Server

_EVERY_S = 0.25


@contextmanager
def status_line(server: Server) -> Iterator[Callable[[float], None]]:
    """Show the line while the twin is served; yields what to call often, with the twin's time.

    Off a terminal there is none.
    """
    screen = Console(stderr=True, highlight=False)
    if not screen.is_terminal:
        yield lambda now: None
        return
    shown_s = 0.0
    with Live(console=screen, auto_refresh=False, transient=True) as live:

        def tick(now: float) -> None:
            nonlocal shown_s
            if monotonic() - shown_s >= _EVERY_S:
                shown_s = monotonic()
                live.update(
                    Text(describe(server, now), no_wrap=True, overflow="ellipsis"), refresh=True
                )

        yield tick


def describe(server: Server, now: float) -> str:
    """Say in one line what the twin does: what moves, what is lit, how many frames it gave."""
    twin = server.twin
    twin.advance_drives(now)
    twin.lamps.advance()
    moving = [
        f"{name} at {drive.axis.actual_deg(now):.1f} deg"
        for name, drive in twin.drives.items()
        if drive.axis.moving
    ]
    lit = several(sum(led.on for led in twin.lamps.leds), "lamp")
    shutter = ", shutter open" if twin.lamps.shutter.status.startswith("OPEN") else ""
    # what moves comes last: it is the longest, and a narrow terminal cuts the end
    return (
        f"{duration(round(now))}: {several(server.camera.frames, 'frame')}, {lit} lit{shutter}, "
        f"{twin.holder} in the holder; {', '.join(moving) or 'nothing moves'}"
    )
