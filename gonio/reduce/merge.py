"""Exposures merged into one rate: by inverse variance, over those that are not saturated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.reduce.reading import Reading


@dataclass(frozen=True)
class Rate:
    """Signal per exposure, channel by channel (camera RGB), each array of shape (3,).

    Attributes
    ----------
    value
        In raw units per (s/mm2): proportional to the BRDF.
    variance
        In that unit squared.
    clipped
        Whether every exposure was saturated; the value then is the shortest one's, a lower bound.
    """

    value: NDArray[np.float64]
    variance: NDArray[np.float64]
    clipped: NDArray[np.bool_]


def merge(readings: Sequence[Reading], gain: float) -> Rate:
    """Merge the readings of one pose, in whatever order.

    An exposure counts for a channel when none of the patch's pixels is saturated. Taking single
    pixels out would keep those with the lower noise. The weights come from the noise that the
    rate of all exposures together foretells, never from a reading's own value, for then low
    readings would weigh more and the mean be too low.

    Parameters
    ----------
    readings
        At least one.
    gain
        Raw units per electron.
    """
    signal = np.array([reading.signal for reading in readings])
    exposure = np.array([reading.exposure for reading in readings])
    pixels = np.array([reading.pixels for reading in readings])
    read_variance = np.array([[reading.read_variance] for reading in readings])
    usable = np.array([~reading.saturated for reading in readings])
    clipped = np.asarray(~usable.any(axis=0))
    usable |= clipped & (exposure == exposure.min(axis=0))
    # signal over exposure of all together is the most likely rate where photons alone make noise
    together = (signal * usable).sum(axis=0) / (exposure * usable).sum(axis=0)
    expected = np.clip(together, 0.0, None) * exposure
    variance = (gain * expected + read_variance) / pixels
    weight = usable * exposure**2 / variance
    total = weight.sum(axis=0)
    return Rate((weight * signal / exposure).sum(axis=0) / total, 1.0 / total, clipped)
