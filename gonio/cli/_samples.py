"""The samples of a session, reduced where they are not."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gonio.samples import Samples
    from gonio.session import Session


def reduced(session: Session) -> Samples:
    """Return the samples of all that was captured; the session is locked by the caller."""
    from gonio.cli._console import progress_bar
    from gonio.reduce import is_reduced, reduce_session
    from gonio.samples import Samples

    if is_reduced(session):
        return Samples.load(session.samples_path)
    began = time.perf_counter()
    with progress_bar("reducing") as progress:
        samples = reduce_session(session, progress=progress)
    session.note_timing("reduce", time.perf_counter() - began)
    return samples
