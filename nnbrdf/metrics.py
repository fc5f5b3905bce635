"""How far an estimate is from the truth, on the 81 x 81 grid: eps8 and male."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FLOOR = 0.01


def eps8(estimate: NDArray[Any], true: NDArray[Any], white: float) -> float:
    """Return the mean absolute difference on an 8-bit scale that ends at white.

    Mikes and Haindl (2023), equations 2 and 3, of b8(f) = 255 clip(f / white, 0, 1).

    Parameters
    ----------
    estimate, true
        BRDF in 1/sr, one shape (..., channel).
    white
        Exposure scale of the true material, in 1/sr.

    Raises
    ------
    BadInputError
        When shapes differ, a number is not finite, or white is not positive.
    """
    return float(eps8_per_channel(estimate, true, white).mean())


def male(estimate: NDArray[Any], true: NDArray[Any], white: float) -> float:
    """Return the mean absolute log error above a floor of 1 % of white.

    That is |ln((estimate + 0.01 white) / (true + 0.01 white))|, the estimate clipped at 0;
    highlights count beyond white. Parameters and errors as for `eps8`.
    """
    return float(male_per_channel(estimate, true, white).mean())


def eps8_per_channel(
    estimate: NDArray[Any], true: NDArray[Any], white: float
) -> NDArray[np.float64]:
    """Return `eps8` of each channel, shape (channels,)."""
    estimate, true = _checked(estimate, true, white)
    difference = np.clip(estimate / white, 0, 1) - np.clip(true / white, 0, 1)
    return _mean_per_channel(255 * difference)


def male_per_channel(
    estimate: NDArray[Any], true: NDArray[Any], white: float
) -> NDArray[np.float64]:
    """Return `male` of each channel, shape (channels,)."""
    estimate, true = _checked(estimate, true, white)
    floor = _FLOOR * white
    return _mean_per_channel(np.log((np.clip(estimate, 0, None) + floor) / (true + floor)))


def _mean_per_channel(difference: NDArray[np.float64]) -> NDArray[np.float64]:
    mean: NDArray[np.float64] = np.abs(difference).reshape(-1, difference.shape[-1]).mean(axis=0)
    return mean


def _checked(
    estimate: NDArray[Any], true: NDArray[Any], white: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    estimate, true = np.asarray(estimate, np.float64), np.asarray(true, np.float64)
    if estimate.shape != true.shape:
        raise BadInputError(
            f"the estimate has shape {estimate.shape} and the truth {true.shape}; "
            "compare them on one grid"
        )
    for name, values in (("estimate", estimate), ("truth", true)):
        if not np.isfinite(values).all():
            raise BadInputError(f"the {name} holds values that are not finite; make it again")
    if not white > 0:
        raise BadInputError(f"white is {white:g}, not positive; it scales the errors")
    return estimate, true
