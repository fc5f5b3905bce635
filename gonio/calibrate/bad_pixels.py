"""Bad pixels: those that no correction makes good."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.calibration import BadPixels

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.calibrate.dark import DarkMaps

# of good pixels, normally distributed, none of a sensor of 1e9 is farther out
_FAR_SD = 7.0
_SD_PER_MAD = 1.4826
_NOISY_TIMES = 8.0
_RESPONSE_OFF = 0.3


def find_bad(
    dark: DarkMaps, response: NDArray[np.float64], smooth: NDArray[np.float64]
) -> tuple[NDArray[np.bool_], BadPixels]:
    """Return which pixels to leave out, shape (height, width), and how many of each kind.

    Hot pixels and wrong offsets lie seven robust standard deviations (1.4826 x the median absolute
    deviation) from the median, noisy ones have eight times the median variance, and those of wrong
    response are 30 % off the smooth fit.

    Parameters
    ----------
    dark
        Offset, rate and variance.
    response, smooth
        As from `gonio.calibrate.flat.FlatField.response`.
    """
    kinds = {
        "hot": _outliers(dark.rate),
        "noisy": dark.variance > _NOISY_TIMES * np.median(dark.variance),
        "offset": _outliers(dark.offset),
        "response": np.abs(response / smooth - 1.0) > _RESPONSE_OFF,
    }
    bad = np.zeros(response.shape, np.bool_)
    counts = {}
    for name, those in kinds.items():
        counts[name] = int((those & ~bad).sum())
        bad |= those
    return bad, BadPixels(**counts)


def _outliers(values: NDArray[np.float64]) -> NDArray[np.bool_]:
    away = values - np.median(values)
    sd = float(_SD_PER_MAD * np.median(np.abs(away)))
    # of values that are all alike none is out
    outliers: NDArray[np.bool_] = (np.abs(away) > _FAR_SD * sd) & (sd > 0)
    return outliers
