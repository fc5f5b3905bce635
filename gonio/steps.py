"""Counting what is done, for whoever watches."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gonio.protocols import Progress


class Steps:
    """Counts steps; each call is one done, and is told.

    Parameters
    ----------
    total
        How many there are, or may be.
    progress
        Called with the number done and the total; None: nobody watches.
    """

    def __init__(self, total: int, progress: Progress | None) -> None:
        self._done, self._total, self._progress = 0, total, progress

    def __call__(self) -> None:
        """Take a step."""
        self._done += 1
        self.show()

    def show(self) -> None:
        """Tell how far it is."""
        if self._progress is not None:
            self._progress(self._done, self._total)
