"""How work that takes a while is followed: a bar for each part, and notes along the way."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING
from warnings import warn

from gonio.protocols import Progress

if TYPE_CHECKING:
    from gonio.adaptive import Round
    from gonio.journal import Journal

Bars = Callable[[str], AbstractContextManager[Progress]]
"""Makes the progress of a part of the work, by the part's name; entered while it goes on."""

Tell = Callable[[str], None]
"""Told a line that a person should know, of what does not keep the work from going on."""


def unseen(title: str) -> AbstractContextManager[Progress]:
    """Follow nothing."""
    return nullcontext(_untold)


def as_warning(text: str) -> None:
    """Tell it as Python tells what is no error."""
    # of this, the function that tells and its caller, the last is nearest to who should know
    warn(text, stacklevel=3)


def _unwatched(journal: Journal) -> AbstractContextManager[None]:
    return nullcontext()


def _untold(*what: object) -> None:
    pass


@dataclass(frozen=True)
class Following:
    """How a capture is followed; by default in silence, but for what should be known.

    Attributes
    ----------
    bars, tell
        See `Bars` and `Tell`.
    told
        Called with each round of an adaptive capture.
    given_up
        Called with how many flagged shots are taken again, once the rig answers.
    meeting, using
        Entered, with the journal, while frames are taken, and while the rig is in use; left
        however that ends.
    """

    bars: Bars = unseen
    tell: Tell = as_warning
    told: Callable[[Round], None] = _untold
    given_up: Callable[[int], None] = _untold
    meeting: Callable[[Journal], AbstractContextManager[None]] = _unwatched
    using: Callable[[Journal], AbstractContextManager[None]] = _unwatched

    @classmethod
    def by(cls, progress: Progress | None) -> Following:
        """Follow every part by one function (done, total)."""
        return cls(bars=lambda title: nullcontext(progress or _untold))
