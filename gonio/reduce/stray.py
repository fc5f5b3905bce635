"""Stray light: the share of a frame's light that lens and camera spread over all of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.calibration import Linearity
    from gonio.reduce.dark import Dark
    from gonio.reduce.raw import RawFrame


def frame_mean(raw: RawFrame, dark: Dark, linearity: Linearity | None) -> NDArray[np.float64]:
    """Return the mean above dark of each channel over the whole frame, shape (3,).

    In raw units of a linear sensor.

    Veiling glare g makes (1 - g) image + g mean of an image (ISO 9358:1994), which leaves the mean
    as it is: so g x this is what it adds. Saturated pixels hide how bright they were; what glare
    they cause is underrated.
    """
    total, count = np.zeros(3), np.zeros(3)
    for place, color in enumerate(raw.sensor.pattern):
        cell = np.s_[place // 2 :: 2, place % 2 :: 2]
        channel = "RGB".index(color)
        light = raw.mosaic[cell] - dark.mean[cell]
        total[channel] += (light if linearity is None else linearity.undo(light)).sum()
        count[channel] += raw.mosaic[cell].size
    return total / count
