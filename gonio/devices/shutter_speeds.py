"""Exposures as cameras write them: `1/250`, `0.0100s`, `2"`, `30`, `bulb`."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Iterable

_SPEED = re.compile(r'(\d+(?:\.\d+)?)(?:/(\d+(?:\.\d+)?))?\s*(?:s|")?', re.IGNORECASE)
# how well a shutter keeps its time (the rig's protocol, "Camera: a folder")
_SHUTTER, _SHUTTER_S = 0.01, 100e-6


def seconds_of(speed: str) -> float | None:
    """Return a shutter speed in seconds; None where it is none, such as `bulb`."""
    found = _SPEED.fullmatch(speed.strip())
    if found is None:
        return None
    whole, part = float(found[1]), float(found[2] or 1.0)
    return whole / part if whole and part else None


def speed_for(exposure_s: float, choices: Iterable[str]) -> str:
    """Return which of a camera's speeds is an exposure, to 1 % and 100 us.

    Raises
    ------
    gonio.errors.BadInputError
        When none is, naming the next ones.
    """
    speeds = {speed: seconds for speed in choices if (seconds := seconds_of(speed))}
    nearest = sorted(speeds, key=lambda speed: abs(speeds[speed] - exposure_s))
    if nearest and is_exposure(speeds[nearest[0]], exposure_s):
        return nearest[0]
    others = f"the next are {', '.join(nearest[:2])}" if nearest else "it offers none"
    raise BadInputError(
        f"camera: has no exposure of {exposure_s:g} s, {others}; change camera.exposures_s in the "
        "rig file, or set the camera to manual (M)"
    )


def is_exposure(seconds: float, exposure_s: float) -> bool:
    """Return whether a shutter that is open for `seconds` keeps an exposure."""
    return abs(seconds - exposure_s) <= _SHUTTER * exposure_s + _SHUTTER_S
