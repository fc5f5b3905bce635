"""How sure a model says it is over the whole grid, and which errors that lets one expect."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Grid = dict[str, NDArray[Any]]

FLOOR = 0.01
"""Share of white that is added to values: nobody asks for a tenth of nothing."""

_Z95 = 1.6448536269514722
_DRAWS = 32


class Expected(NamedTuple):
    """What a model's own bands say of its error.

    Attributes
    ----------
    eps8, male
        Means of the metrics, were the bands those of a normal distribution of ln(f + 0.01 white).
    sigma
        Median over pairs and channels of the standard uncertainty over the value.
    deviation
        Root mean square of the standard deviation of ln(f + 0.01 white).
    """

    eps8: float
    male: float
    sigma: float
    deviation: float


def expected_of(grid: Grid, white: float) -> Expected:
    """Return what the bands of `grid`, arrays of shape (81, 81, 3) in 1/sr, let one expect."""
    deviation = log_deviation(grid, white)
    return Expected(
        eps8=_eps8(grid["values"].astype(np.float64), deviation, white),
        # the mean of the absolute value of a normal deviate
        male=float(np.sqrt(2.0 / np.pi) * deviation.mean()),
        sigma=float(np.median(grid["sigma"] / (grid["values"] + FLOOR * white))),
        deviation=float(np.sqrt(np.mean(deviation**2))),
    )


def relative_sigma(grid: Grid, white: float) -> Array:
    """Return standard uncertainty over value, mean of the channels, shape (81, 81)."""
    ratio = grid["sigma"] / (grid["values"] + FLOOR * white)
    return np.asarray(ratio.mean(axis=2), np.float64)


def log_deviation(grid: Grid, white: float) -> Array:
    """Return the standard deviation of ln(f + 0.01 white) by the 5 to 95 % band, as `grid`."""
    low, high = (np.log(grid[end].astype(np.float64) + FLOOR * white) for end in ("lo", "hi"))
    return np.asarray((high - low) / (2.0 * _Z95))


def _eps8(values: Array, deviation: Array, white: float) -> float:
    from scipy.special import ndtri

    middle, told = np.log(values + FLOOR * white), _b8(values / white)
    draws = ndtri((np.arange(_DRAWS) + 0.5) / _DRAWS)
    drawn = (_b8(np.exp(middle + z * deviation) / white - FLOOR) for z in draws)
    return float(np.mean([np.abs(each - told).mean() for each in drawn]))


def _b8(share: Array) -> Array:
    return 255.0 * share.clip(0.0, 1.0)
