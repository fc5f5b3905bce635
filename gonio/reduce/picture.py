"""A raw frame as a picture in which a detector finds the board."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.reduce.frames import Frame
    from gonio.reduce.raw import RawFrame

# what is brighter than all but so few pixels is taken for glare
_BRIGHT_PERCENT = 99.0
_SHARE_SATURATED = 1e-3


def picture_of(raw: RawFrame) -> NDArray[np.uint8]:
    """Return a frame as a grey picture, shape (height, width).

    Each filter's pixels are scaled by themselves, so that the mosaic does not show on white; the
    root gives dark squares as much contrast as noise allows.
    """
    light = raw.mosaic.astype(np.float32) - raw.sensor.black
    for row, column in np.ndindex(2, 2):
        pixels = light[row::2, column::2]
        pixels /= max(float(np.percentile(pixels[::4, ::4], _BRIGHT_PERCENT)), 1.0)
    return np.asarray(255.0 * np.sqrt(light.clip(0.0, 1.0)), np.uint8)


def color_picture_of(raw: RawFrame) -> NDArray[np.uint8]:
    """Return a frame as a small picture, blue first, shape (height // 2, width // 2, 3).

    One pixel for each cell of the mosaic, each channel by itself scaled to its brightest.
    """
    light = raw.mosaic.astype(np.float64) - raw.sensor.black
    height, width = raw.sensor.height // 2, raw.sensor.width // 2
    picture = np.zeros((height, width, 3))
    for place, color in enumerate(raw.sensor.pattern):
        cell = light[place // 2 :: 2, place % 2 :: 2][:height, :width]
        picture[..., "BGR".index(color)] += cell / raw.sensor.pattern.count(color)
    picture /= np.percentile(picture, _BRIGHT_PERCENT, axis=(0, 1)).clip(1.0)
    return np.asarray(255.0 * picture.clip(0.0, 1.0) ** (1.0 / 2.2), np.uint8)


def best_exposed(bracket: Sequence[Frame], middle: float = 1.0) -> Frame:
    """Return the longest exposure that is hardly saturated, or else the shortest.

    Parameters
    ----------
    bracket
        Frames of one shot.
    middle
        Share of each side of the frame, about its centre, that is looked at.
    """
    rising = sorted(bracket, key=lambda frame: frame.raw.exposure_s)
    good = [frame for frame in rising if _saturated(frame.raw, middle) < _SHARE_SATURATED]
    return (good or rising[:1])[-1]


def _saturated(raw: RawFrame, middle: float) -> float:
    top, left = (round(side * (1.0 - middle) / 2.0) for side in raw.mosaic.shape)
    seen = raw.mosaic[top : raw.mosaic.shape[0] - top, left : raw.mosaic.shape[1] - left]
    return float(np.mean(seen >= raw.sensor.saturation))
