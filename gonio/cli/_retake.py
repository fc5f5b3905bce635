"""`gonio capture --retake`: the shots that the checks flagged are given up once the rig answers."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from gonio.words import several

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.capture import Instrument, Operator
    from gonio.cli._measure import Driven
    from gonio.session import Session


@contextlib.contextmanager
def without_suspects(session: Session, driven: Driven) -> Iterator[tuple[Instrument, Operator]]:
    """Connect as `driven` does, and then reject the frames of flagged shots.

    The session is locked by the caller.
    """
    from gonio.capture.retake import flagged, give_up
    from gonio.cli._console import console

    with driven as connected:
        # no sooner: what was measured counts until the rig is there to take it anew
        with session.journal(writing=True) as journal:
            count = give_up(flagged(session), journal)
        console.print(f"{several(count, 'flagged shot')} to take again")
        yield connected
