"""Channels that are multiples of one: grey and singly tinted materials need one output."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gonio.samples import Flag

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.samples import Samples

_MOST = 0.01
_SIGMAS = 2.0
_FLOOR = 0.01


def single_spectrum(samples: Samples) -> NDArray[np.float64] | None:
    """Return each channel over their mean where one factor a channel explains all samples.

    It does where the median departure of ln(value + 1 % of white) from the factor's is within
    one per cent, or two of the samples' own sigmas.

    Returns
    -------
    ndarray or None
        Shape (channels,), of mean 1; None where the channels differ by more, or there is but one.
    """
    if len(samples.channels) < 2 or (samples.flag & Flag.CLIPPED).any():
        return None
    mean = samples.value.mean(axis=1, keepdims=True)
    bright = mean[:, 0] > _FLOOR * samples.white
    factor = np.median(samples.value[bright] / mean[bright], axis=0)
    if not (factor > 0).all():
        return None
    floor = _FLOOR * samples.white
    off = np.log((samples.value.clip(0) + floor) / (factor * mean.clip(0) + floor))
    own = np.nan_to_num(samples.sigma) / (samples.value.clip(0) + floor)
    return factor / factor.mean() if _within(np.abs(off), own) else None


def _within(off: NDArray[np.float64], own: NDArray[np.float64]) -> bool:
    return bool((np.quantile(off, 0.9, axis=0) <= _MOST + _SIGMAS * np.median(own, axis=0)).all())


def as_one_channel(samples: Samples, factor: NDArray[np.float64]) -> Samples:
    """Return samples of the one channel of which the others are multiples."""
    sigma = samples.sigma / factor / np.sqrt(len(factor))
    return replace(
        samples,
        value=(samples.value / factor).mean(axis=1, keepdims=True),
        sigma=np.sqrt((sigma**2).sum(axis=1, keepdims=True) / len(factor)),
        flag=np.bitwise_or.reduce(samples.flag, axis=1, keepdims=True),
        channels=("y",),
    )
