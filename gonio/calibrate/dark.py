"""Dark frames of several exposures: each pixel's offset and dark current."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from gonio.calibrate.exposing import Exposed


class Stack:
    """Mean and variance of each pixel over frames, one frame at a time (Welford's recurrence)."""

    def __init__(self) -> None:
        self.count = 0
        self._mean: NDArray[np.float64] | None = None
        self._squares: NDArray[np.float64] | None = None

    def add(self, mosaic: NDArray[np.uint16]) -> None:
        """Add a frame, shape (height, width)."""
        values = mosaic.astype(np.float64)
        self.count += 1
        if self._mean is None or self._squares is None:
            self._mean, self._squares = values, np.zeros(values.shape)
            return
        away = values - self._mean
        self._mean += away / self.count
        self._squares += away * (values - self._mean)

    @property
    def mean(self) -> NDArray[np.float64]:
        """Of each pixel, shape (height, width)."""
        assert self._mean is not None
        return self._mean

    @property
    def variance(self) -> NDArray[np.float64]:
        """Of each pixel from frame to frame, shape (height, width); two frames at least."""
        assert self._squares is not None
        return self._squares / (self.count - 1)


def dark_before(dark: Sequence[Exposed], lit: Sequence[Exposed]) -> NDArray[np.float64]:
    """Return the mean of dark frames as it was when lit ones were taken, shape (height, width).

    A sensor in use gets warmer: the line through the dark frames' levels is followed back.
    """
    when, before = (np.array([frame.since_start_s for frame in each]) for each in (dark, lit))
    mean = np.mean([frame.raw.mosaic for frame in dark], axis=0)
    away = when - when.mean()
    levels = np.array([frame.raw.mosaic.mean() for frame in dark])
    growth = float(away @ levels / (away @ away))
    return np.asarray(mean + growth * (before.mean() - when.mean()))


@dataclass(frozen=True)
class DarkMaps:
    """What each pixel says without light, in raw units, shapes (height, width).

    Attributes
    ----------
    offset
        After no time, black level included.
    rate
        What it gains in a second, at the sensor's temperature of then.
    variance
        From frame to frame, mean over all exposures.
    read_variance
        Of the shortest exposure, mean over all pixels.
    """

    offset: NDArray[np.float64]
    rate: NDArray[np.float64]
    variance: NDArray[np.float64]
    read_variance: float


def dark_maps(stacks: Mapping[float, Stack]) -> DarkMaps:
    """Fit a line through each pixel's means over the exposures in seconds.

    One exposure alone tells no rate, which is 0 then.
    """
    exposures = sorted(stacks)
    times = np.array(exposures)
    centre = times.mean()
    level = sum((stacks[s].mean for s in exposures), np.zeros(1)) / len(times)
    spread = float(((times - centre) ** 2).sum())
    rate = np.zeros(level.shape)
    if spread:
        slope = sum(((s - centre) * stacks[s].mean for s in exposures), np.zeros(1))
        rate = slope / spread
    variance = sum((stacks[s].variance for s in exposures), np.zeros(1)) / len(times)
    shortest = stacks[exposures[0]].variance.mean()
    return DarkMaps(level - rate * centre, rate, variance, float(shortest))
