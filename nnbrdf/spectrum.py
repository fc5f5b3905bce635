"""Channels that are multiples of one: grey and singly tinted materials need one output."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gonio.samples import Flag, Samples

if TYPE_CHECKING:
    from numpy.typing import NDArray

_MOST = 0.01
_SIGMAS = 2.0
_FLOOR = 0.01
_MANY = 0.5


def single_spectrum(samples: Samples) -> NDArray[np.float64] | None:
    """Return each channel over their mean where one factor a channel explains all samples.

    It does where nine of ten departures of ln(value + 1 % of white) from the factor's are within
    one per cent plus two of the samples' own sigmas. Clipped samples are not asked.

    Returns
    -------
    ndarray or None
        Shape (channels,), of mean 1; None where the channels differ by more, or there is but one.
    """
    clipped = np.asarray((samples.flag & Flag.CLIPPED).any(axis=1))
    if len(samples.channels) < 2 or clipped.mean() > _MANY:
        return None
    samples = _rows(samples, ~clipped)
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


def _rows(samples: Samples, rows: NDArray[np.bool_]) -> Samples:
    return Samples.from_values(
        samples.light[rows], samples.view[rows], samples.value[rows], samples.sigma[rows],
        samples.channels,
    )  # fmt: skip


def as_one_channel(samples: Samples, factor: NDArray[np.float64]) -> Samples:
    """Return samples of the one channel of which the others are multiples."""
    # by each channel's own brightness: a dark one tells little of the others
    weight = factor**2 / (factor**2).sum()
    return replace(
        samples,
        value=(weight * samples.value / factor).sum(axis=1, keepdims=True),
        sigma=np.sqrt(((weight * samples.sigma / factor) ** 2).sum(axis=1, keepdims=True)),
        flag=np.bitwise_or.reduce(samples.flag, axis=1, keepdims=True),
        channels=("y",),
    )
