"""The samples of a session, reduced where they are not."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.api.following import Bars
    from gonio.protocols import Progress
    from gonio.samples import Samples
    from gonio.session import Session


def reduced(session: Session, bars: Bars) -> Samples:
    """Return the samples of all that was captured; the session is locked by the caller."""
    from gonio.reduce import is_reduced, reduce_session
    from gonio.samples import Samples

    if is_reduced(session):
        return Samples.load(session.samples_path)
    began = time.perf_counter()
    with bars("reducing") as progress:
        samples = reduce_session(session, progress=progress)
    session.note_timing("reduce", time.perf_counter() - began)
    return samples


def reduce_anew(
    session: Session,
    geometry: Path | None,
    color: Path | None,
    progress: Progress | None,
    **settings: Any,
) -> Samples:
    """Reduce a session, whatever is there, and note what that took.

    Parameters
    ----------
    session
        It is locked meanwhile.
    geometry, color
        Files that the session is to keep and to go by; None: those that it keeps.
    progress
        Called with how much is done and how much there is.
    settings
        More of `gonio.reduce.reduce_session`.
    """
    from gonio.reduce import reduce_session
    from gonio.reduce.color import keep_color
    from gonio.reduce.poses import keep_geometry

    began = time.perf_counter()
    with session.lock():
        if geometry is not None:
            keep_geometry(geometry, session)
        if color is not None:
            keep_color(color, session)
        samples = reduce_session(session, progress=progress, **settings)
        session.note_timing("reduce", time.perf_counter() - began)
    return samples
