"""The truth of a simulated session, which nothing else may read."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from gonio.errors import BadFileError

if TYPE_CHECKING:
    from gonio.materials import MeasuredTable
    from gonio.session import Session

_log = logging.getLogger(__name__)


def truth_of(session: Session | None) -> MeasuredTable | None:
    """Return the truth, if it is there and can be read: a report is due without it."""
    from gonio.materials import MeasuredTable

    if session is None or not session.truth_path.is_file():
        return None
    try:
        return MeasuredTable.load(session.truth_path)
    except BadFileError as error:
        _log.warning("%s", error)
        return None
