"""Seconds that add up, and how sure their sum is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gonio.timing import Spread

_Z95 = 1.6448536269514722


@dataclass
class Budget:
    """A sum of times.

    What varies from one occurrence to the next adds up in square; what is wrong alike in each, as
    a mean or a speed is, adds up as it is, and so does that of different means: who measured one
    too long may have measured all too long.

    Attributes
    ----------
    total_s
        The sum of the means.
    variance_s2
        Of the sum, from what is independent.
    common_s
        Standard uncertainty of the sum, from what is common.
    """

    total_s: float = 0.0
    variance_s2: float = 0.0
    common_s: float = 0.0

    def add(self, time: Spread, count: float = 1.0) -> float:
        """Add a time that occurs `count` times; return the seconds that these take."""
        self.variance_s2 += count * time.sd_s**2
        self.common_s += count * time.error_s
        self.total_s += count * time.mean_s
        return count * time.mean_s

    def add_seconds(self, seconds: float, variance_s2: float = 0.0, common_s: float = 0.0) -> float:
        """Add seconds with what is known of their spread; return them."""
        self.variance_s2 += variance_s2
        self.common_s += common_s
        self.total_s += seconds
        return seconds

    @property
    def interval_s(self) -> tuple[float, float]:
        """The 5 and 95 % quantiles of a normal distribution, the lower not below zero."""
        reach = _Z95 * math.hypot(math.sqrt(self.variance_s2), self.common_s)
        return max(self.total_s - reach, 0.0), self.total_s + reach
