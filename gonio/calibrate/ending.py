"""Where raw values end: at WhiteLevel, or before it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.calibrate.lighting import FAINTEST
from gonio.reduce.raw import SATURATED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.calibrate.exposing import Exposed

# of what shorter exposures foretell: no sensor in use bends by that much before its end
_SHORT_OF = 0.8
# pixels end at levels of their own, and few of them are below that
_LOW_PERCENT = 1.0
# below, a coarse sensor has most readings at one value by itself
_PILES_FROM = 0.2
# a longer exposure reads no more, but for how pixels differ
_NO_MORE = 1.05


class End(NamedTuple):
    """Where a sensor's raw values end.

    Attributes
    ----------
    black, above
        BlackLevel, and how far above it, in raw units.
    seen
        Whether frames showed it; if not it is WhiteLevel, which the file states.
    """

    black: int
    above: float
    seen: bool

    @property
    def saturation(self) -> float:
        """The raw value from which a pixel counts as saturated: sensors bend before they end."""
        return self.black + SATURATED * self.above


def end_of(
    probes: Sequence[Exposed],
    masks: Sequence[NDArray[np.bool_]],
    darks: Sequence[NDArray[np.float64]],
) -> End:
    """Tell where raw values end by the longest exposure of the white reference.

    A channel is at its end where readings pile up, half of them at one value, or are far short of
    what a shorter exposure foretells, light being exposure x the lamps' flux; and where the longest
    exposure reads no more.

    Parameters
    ----------
    probes
        One frame for each exposure, rising.
    masks
        Pixels of each channel, shape (height, width) each.
    darks
        What each frame reads without light, shape (height, width) each.
    """
    sensor = probes[0].raw.sensor
    whole = float(sensor.white - sensor.black)
    frames = list(zip(probes, darks, strict=True))
    channels = [[_seen(probe, dark, mask) for probe, dark in frames] for mask in masks]
    ended = [raw for channel in channels if (raw := _at_its_end(channel, whole)).size]
    if not ended:
        return End(sensor.black, whole, seen=False)
    above = float(np.percentile(np.concatenate(ended), _LOW_PERCENT))
    return End(sensor.black, min(above, whole), seen=True)


class _Seen(NamedTuple):
    """What a channel's pixels read above BlackLevel and above dark, and the light, in any unit."""

    raw: NDArray[np.float64]
    signal: NDArray[np.float64]
    dose: float


def _seen(probe: Exposed, dark: NDArray[np.float64], mask: NDArray[np.bool_]) -> _Seen:
    raw = probe.raw.mosaic[mask].astype(np.float64)
    dose = probe.raw.exposure_s * sum(probe.flux)
    return _Seen(raw - probe.raw.sensor.black, raw - float(dark[mask].mean()), dose)


def _at_its_end(channel: Sequence[_Seen], whole: float) -> NDArray[np.float64]:
    """Return a channel's readings in the longest exposure if they are at their end, or none."""
    signal_per_dose, longest = 0.0, channel[-1]
    for _, signal, dose in channel:
        low, middle, high = np.percentile(signal, (25, 50, 75))
        if middle < FAINTEST * whole:
            continue
        piles_up = low == high and middle > _PILES_FROM * whole
        falls_short = middle < _SHORT_OF * signal_per_dose * dose
        if (piles_up or falls_short) and np.median(longest.signal) < _NO_MORE * middle:
            return longest.raw
        signal_per_dose = middle / dose
    return np.zeros(0)
