"""The truth of a simulated session, which nothing else may read."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np

from gonio.color import SRGB, srgb_from
from gonio.errors import BadFileError

if TYPE_CHECKING:
    from gonio.materials import MeasuredTable
    from gonio.session import Session

_log = logging.getLogger(__name__)


def truth_of(session: Session | None, color_space: str) -> MeasuredTable | None:
    """Return the truth in a color space, if it is there and can be read.

    A report is due without it, too: in the camera's own channels nobody knows it.
    """
    from gonio.materials import MeasuredTable

    if session is None or not session.truth_path.is_file():
        return None
    try:
        truth = MeasuredTable.load(session.truth_path)
    except BadFileError as error:
        _log.warning("%s", error)
        return None
    if color_space == SRGB:
        return truth
    to_srgb = srgb_from(color_space)
    if to_srgb is None:
        _log.warning("the truth is in %s, and nothing in %s is held against it", SRGB, color_space)
        return None
    return MeasuredTable.of(truth.values @ np.linalg.inv(to_srgb).T)
