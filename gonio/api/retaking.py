"""Taking flagged shots again: they are given up once the rig answers."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from gonio.api.measuring import Driven
    from gonio.capture import Instrument, Operator
    from gonio.session import Session


@contextlib.contextmanager
def without_suspects(
    session: Session, driven: Driven, given_up: Callable[[int], None]
) -> Iterator[tuple[Instrument, Operator]]:
    """Connect as `driven` does, and then reject the frames of flagged shots.

    The session is locked by the caller, and `given_up` is told how many shots that are.
    """
    from gonio.capture.retake import flagged, give_up

    with driven as connected:
        # no sooner: what was measured counts until the rig is there to take it anew
        with session.journal(writing=True) as journal:
            given_up(give_up(flagged(session), journal))
        yield connected
