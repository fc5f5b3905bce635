"""Stray light: what lens and camera spread over all of a frame, and about what is bright."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.calibration import Linearity
    from gonio.reduce.correction import Correction
    from gonio.reduce.dark import Dark
    from gonio.reduce.patch import Patch
    from gonio.reduce.raw import RawFrame
    from gonio.reduce.reading import Reading
    from gonio.rig import Rig

    _Weights = tuple[NDArray[np.float64], NDArray[np.float64]]


def frame_mean(raw: RawFrame, dark: Dark, linearity: Linearity | None) -> NDArray[np.float64]:
    """Return the mean above dark of each channel over the whole frame, shape (3,).

    In raw units of a linear sensor.

    Veiling glare g makes (1 - g) image + g mean of an image (ISO 9358:1994), which leaves the mean
    as it is: so g x this is what it adds. Saturated pixels hide how bright they were
    (`by_the_unhidden`, `surrounds`).
    """
    mean = _weighted(raw, dark, linearity, [_even(raw)])[0]
    return np.asarray(mean)


_HOT_SHARE = 0.002


@dataclass(frozen=True)
class Stray:
    """What falls on a patch that comes from elsewhere, in raw units, shape (3,) each.

    Attributes
    ----------
    surround
        The frame's mean, of which the veil is a share; 0 where nothing tells of stray light.
    around
        The mean about the patch, less the veil, of which the halo is a share; 0 where none is
        known.
    taken
        What is to be taken off.
    hidden
        Share of the frame's pixels that are saturated, so that nobody knows what they spread.
    """

    surround: NDArray[np.float64]
    around: NDArray[np.float64]
    taken: NDArray[np.float64]
    hidden: float


def stray_on(patch: Patch, raw: RawFrame, dark: Dark, rig: Rig, correction: Correction) -> Stray:
    """Return the stray light on a patch of a frame."""
    share, halo = rig.camera.stray_light or correction.stray_light, correction.halo
    surround, around, hidden = np.zeros(3), np.zeros(3), 0.0
    # of large frames a sum of all pixels takes its time
    if halo:
        weights = [_even(raw), _bell(raw, patch, halo.width * raw.sensor.width)]
        surround, around = _weighted(raw, dark, correction.linearity, weights)
        around = around - share * surround
    elif share or rig.uncertainty.stray_light or correction.doubt.stray_light:
        surround = frame_mean(raw, dark, correction.linearity)
    if surround.any():
        hidden = float((raw.mosaic >= correction.saturation(raw.sensor)).mean())
    taken = share * surround + (halo.share if halo else 0.0) * around
    return Stray(surround, around, taken, hidden)


def by_the_unhidden(readings: Sequence[Reading]) -> list[Reading]:
    """Return readings of one pose, stray light told by exposures that show all that sheds it.

    A long exposure saturates what is bright, and takes too little off beside it. The longest one
    that saturates no more than hot pixels tells what was there, or else the shortest.

    Parameters
    ----------
    readings
        At least one, in whatever order.
    """
    hidden = [each.hidden for each in readings]
    known = readings[_teller(hidden, [float(each.exposure.sum()) for each in readings])]
    return [each if each.hidden <= _HOT_SHARE else _told_by(known, each) for each in readings]


def surrounds(
    raws: Sequence[RawFrame],
    darks: Sequence[Dark],
    exposures: Sequence[float],
    linearity: Linearity | None,
    saturation: float,
) -> list[NDArray[np.float64]]:
    """Return the means of a pose's frames as `frame_mean` does, told as in `by_the_unhidden`.

    Parameters
    ----------
    raws, darks, exposures
        By frame; exposures in any unit.
    linearity, saturation
        Of the sensor.
    """
    hidden = [float((raw.mosaic >= saturation).mean()) for raw in raws]
    known = _teller(hidden, exposures)
    mean = frame_mean(raws[known], darks[known], linearity)
    return [
        mean * (exposures[number] / exposures[known])
        if share > _HOT_SHARE
        else frame_mean(raws[number], darks[number], linearity)
        for number, share in enumerate(hidden)
    ]


def _teller(hidden: Sequence[float], exposures: Sequence[float]) -> int:
    """Return the longest exposure that saturates no more than hot pixels, or else the shortest."""
    numbers = sorted(range(len(exposures)), key=lambda number: exposures[number])
    shown = [number for number in numbers if hidden[number] <= _HOT_SHARE]
    return shown[-1] if shown else numbers[0]


def _told_by(known: Reading, reading: Reading) -> Reading:
    times = reading.exposure / known.exposure
    told = {name: times * getattr(known, name) for name in ("surround", "around", "stray")}
    return replace(reading, signal=reading.signal + reading.stray - told["stray"], **told)


def _even(raw: RawFrame) -> _Weights:
    rows, columns = (np.ones(side) for side in raw.mosaic.shape)
    return rows, columns


def _bell(raw: RawFrame, patch: Patch, width_px: float) -> _Weights:
    rows, columns = (
        np.exp(-0.5 * ((np.arange(side) - where.mean()) / width_px) ** 2)
        for side, where in zip(raw.mosaic.shape, (patch.rows, patch.columns), strict=True)
    )
    return rows, columns


def _weighted(
    raw: RawFrame, dark: Dark, linearity: Linearity | None, weights: Sequence[_Weights]
) -> NDArray[np.float64]:
    """Return weighted means of each channel, shape (n, 3)."""
    total, weight = np.zeros((2, len(weights), 3))
    for place, color in enumerate(raw.sensor.pattern):
        down, over = np.s_[place // 2 :: 2], np.s_[place % 2 :: 2]
        channel = "RGB".index(color)
        light = raw.mosaic[down, over] - dark.mean[down, over]
        linear = light if linearity is None else linearity.undo(light)
        for number, (rows, columns) in enumerate(weights):
            total[number, channel] += rows[down] @ linear @ columns[over]
            weight[number, channel] += rows[down].sum() * columns[over].sum()
    return np.asarray(total / weight)
