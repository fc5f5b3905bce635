"""What drivers met and mended by themselves, for whoever keeps the record."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


class Troubles:
    """Takes note of what was asked again, read again or waited for.

    Attributes
    ----------
    listener
        Called with what happened and what was done about it; None where nobody keeps a record.
    leaving
        Whether all is being shut down: then what does not answer is hardly waited for.
    """

    def __init__(self) -> None:
        self.listener: Callable[[str, str], None] | None = None
        self.leaving = False

    def note(self, what: str, did: str) -> None:
        """Tell the listener."""
        if self.listener is not None:
            self.listener(what, did)
