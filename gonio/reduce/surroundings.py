"""What a shot shows around the sample: how bright the holder is, and how sharp the edge."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.reduce.holder import holder_level
from gonio.reduce.sharpness import edge_width_px

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.reduce.calibrate import Calibration
    from gonio.reduce.frames import Frame
    from gonio.reduce.holder import HolderLevel
    from gonio.rig import Rig


@dataclass(frozen=True)
class Surroundings:
    """The holder in one shot.

    Attributes
    ----------
    holder
        Its white squares; None where not seen.
    blur_px
        Of the sample's edge; None where not seen.
    """

    holder: HolderLevel | None = None
    blur_px: float | None = None


def look_around(bracket: Sequence[Frame], rig: Rig, calibration: Calibration) -> Surroundings:
    """Read the holder in the longest exposure in which it is not saturated, if it is seen."""
    for frame in sorted(bracket, key=lambda frame: -frame.record.exposure_s):
        dark = calibration.darks[frame.record.exposure_s]
        level = holder_level(frame, dark, calibration.gain, rig, calibration.correction)
        if level is not None:
            width = edge_width_px(frame, dark, rig.camera, calibration.correction)
            return Surroundings(level, width)
    return Surroundings()
