"""Exposures merged into one rate: by inverse variance, over those that are not saturated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from gonio.reduce.reading import Reading


class Weights(NamedTuple):
    """What each of n exposures counts for, shape (n, ...).

    Attributes
    ----------
    per_signal
        Of each, the change of the rate with its signal.
    share
        Of each, which add up to one.
    expected
        Signal that the rate of all together foretells, not negative.
    certainty
        Inverse variance of the rate, shape (...).
    clipped
        Whether every exposure was saturated, shape (...); the shortest alone counts then.
    """

    per_signal: NDArray[np.float64]
    share: NDArray[np.float64]
    expected: NDArray[np.float64]
    certainty: NDArray[np.float64]
    clipped: NDArray[np.bool_]


def weigh(
    signal: NDArray[np.float64],
    exposure: NDArray[np.float64],
    saturated: NDArray[np.bool_],
    noise: ArrayLike,
    gain: float,
    pixels: ArrayLike = 1,
) -> Weights:
    """Weigh exposures by inverse variance, those that are saturated left out.

    The variance is gain x expected signal + noise, over the pixels that a signal is the mean of.
    What is expected comes from the rate of all exposures together, never from a reading's own
    value, for then low readings would weigh more and the mean be too low (see
    docs/decisions/004-noise-model.md).

    Parameters
    ----------
    signal, exposure, saturated
        Of n exposures, shape (n, ...), in whatever order.
    noise
        Variance of a pixel that does not come with the signal, in raw units squared.
    gain
        Raw units per electron.
    pixels
        How many pixels each signal is the mean of.
    """
    clipped = np.asarray(saturated.all(axis=0))
    usable = ~saturated | (clipped & (exposure == exposure.min(axis=0)))
    # signal over exposure of all together is the most likely rate where photons alone make noise
    together = (signal * usable).sum(axis=0) / (exposure * usable).sum(axis=0)
    expected = np.clip(together, 0.0, None) * exposure
    certainty = usable * exposure**2 * pixels / (gain * expected + noise)
    total = certainty.sum(axis=0)
    share = certainty / total
    return Weights(share / exposure, share, expected, total, clipped)


@dataclass(frozen=True)
class Rate:
    """Signal per exposure, channel by channel (camera RGB), each array of shape (3,).

    Attributes
    ----------
    value
        In raw units per (s/mm2): proportional to the BRDF.
    photon, read, dark
        Variances by their cause, in that unit squared.
    per_signal
        Of each reading, the change of the rate with its signal, shape (n, 3).
    weights
        Of each reading, which add up to one, shape (n, 3).
    clipped
        Whether every exposure was saturated; the value then is the shortest one's, a lower bound.
    """

    value: NDArray[np.float64]
    photon: NDArray[np.float64]
    read: NDArray[np.float64]
    dark: NDArray[np.float64]
    per_signal: NDArray[np.float64]
    weights: NDArray[np.float64]
    clipped: NDArray[np.bool_]

    @property
    def variance(self) -> NDArray[np.float64]:
        """Of all three causes, shape (3,)."""
        return self.photon + self.read + self.dark


def merge(readings: Sequence[Reading], gain: float) -> Rate:
    """Merge the readings of one pose, in whatever order (see `weigh`).

    An exposure counts for a channel when none of the patch's pixels is saturated. Taking single
    pixels out would keep those with the lower noise.

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
    stray = np.array([reading.stray for reading in readings])
    read = np.array([[reading.read_variance] for reading in readings])
    dark = np.array([[reading.dark_variance] for reading in readings])
    saturated = np.array([reading.saturated for reading in readings])
    of_stray = gain * np.clip(stray, 0.0, None)
    found = weigh(signal, exposure, saturated, of_stray + read + dark, gain, pixels)
    spread = found.per_signal**2 / pixels
    return Rate(
        value=(found.per_signal * signal).sum(axis=0),
        photon=(spread * (gain * found.expected + of_stray)).sum(axis=0),
        read=(spread * read).sum(axis=0),
        dark=(spread * dark).sum(axis=0),
        per_signal=found.per_signal,
        weights=found.share,
        clipped=found.clipped,
    )
