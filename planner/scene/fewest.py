"""How few shots keep an accuracy."""

from __future__ import annotations

from itertools import count
from math import inf, isinf, log
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

_NEAR = 0.02
"""To which share of itself the count is found: two choices of as many shots differ by as much."""


def fewest(error: Callable[[int], float], target: float, most: int) -> int:
    """Return the least count with an error of no more than `target`; `most` if that has more.

    Errors fall about as a power of the count, so the search goes by straight lines between
    logarithms, and every third time by the middle, so that it cannot creep.

    Parameters
    ----------
    error
        Of a count, falling, not negative.
    target
        What is asked for.
    most
        The largest count, 1 or more.
    """
    high, error_high = most, error(most)
    low, error_low = 0, inf
    if error_high > target:
        return most
    for step in count(1):
        margin = max(1, int(_NEAR * high))
        if high - low <= margin:
            break
        guess = (
            _crossing(low, error_low, high, error_high, target) if step % 3 else (low + high) / 2
        )
        middle = round(min(max(guess, low + margin), high - margin))
        found = error(middle)
        if found > target:
            low, error_low = middle, found
        else:
            high, error_high = middle, found
    return high


def _crossing(low: int, error_low: float, high: int, error_high: float, target: float) -> float:
    """Return where the power law through two counts meets the target."""
    if error_high <= 0:
        return (low + high) / 2
    # of one count alone: as if errors fell as the root of it
    power = 0.5 if isinf(error_low) else log(error_low / error_high) / log(high / low)
    return float(high * (error_high / target) ** (1 / power))
