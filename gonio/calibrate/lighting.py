"""Which exposure and current give a level of the white reference."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.errors import BadInputError
from gonio.plan import LampSetting

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.calibrate.ending import End
    from gonio.calibrate.exposing import Exposed
    from gonio.rig import Rig

FULL_CURRENT_MA: Final = 700.0

FAINTEST: Final = 0.01
"""Share of the range below which a level tells little."""


def all_lamps(rig: Rig, current_mA: float = FULL_CURRENT_MA) -> list[LampSetting]:
    """Return every lamp of a rig at one current."""
    return [LampSetting(n=lamp.n, mA=round(current_mA, 1)) for lamp in rig.lamps.lamp]


def level_of(frame: Exposed, patch: NDArray[np.bool_], end: End) -> float | None:
    """Return the share of the range that a frame's brightest channel fills; None of a full one."""
    raw = frame.raw.mosaic[patch]
    if raw.max() >= end.saturation:
        return None
    return float(np.percentile(raw, 95) - end.black) / end.above


def level_per_s(frames: Sequence[Exposed], patch: NDArray[np.bool_], end: End) -> float:
    """Return the share of the range that the brightest channel gains in a second, all lamps full.

    Raises
    ------
    gonio.errors.BadInputError
        When no exposure shows the white reference.
    """
    levels = [(level_of(frame, patch, end), frame.raw.exposure_s) for frame in frames]
    known = [level / seconds for level, seconds in levels if level and level > FAINTEST]
    if not known:
        raise BadInputError(
            "the white reference is too bright or too dark at every exposure of the rig file; "
            "lay it in the holder, or add to camera.exposures_s one that shows it"
        )
    # the longest such exposure is the surest
    return known[-1]


def setting_for(level: float, per_s: float, exposures_s: Sequence[float]) -> tuple[float, float]:
    """Return the exposure in seconds and the current in mA that come nearest to a level.

    The shortest exposure that reaches it at full current, dimmed; the longest, where none does.

    Parameters
    ----------
    level
        Share of the range.
    per_s
        What a second at full current gives.
    exposures_s
        To choose from, rising.
    """
    for exposure_s in exposures_s:
        if per_s * exposure_s >= level:
            return exposure_s, FULL_CURRENT_MA * level / (per_s * exposure_s)
    return exposures_s[-1], FULL_CURRENT_MA
