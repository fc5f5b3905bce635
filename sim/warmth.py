"""How warm lamps and sensor are: what they were used for shows in what they do."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_WARM_UP_S: Final = 300.0


@dataclass(frozen=True)
class Warmth:
    """Means over an exposure.

    Attributes
    ----------
    junctions_c
        Temperatures of lamps 1 to 11 in deg C, shape (11,).
    sensor
        From 0 (rested) to 1 (in use for long).
    """

    junctions_c: NDArray[np.float64]
    sensor: float


COOL: Final = Warmth(np.full(11, 25.0), 0.0)
"""Lamps at the temperature at which their flux is 1, and a rested sensor."""


class SensorHeat:
    """A sensor that warms up while it is exposed and cools down else, in closed form.

    Its time constant of 5 minutes is that of a small body of metal in still air.
    """

    def __init__(self, now: float) -> None:
        self._in_use = False
        self._since_s = now
        self._start = 0.0

    def use(self, now: float, *, in_use: bool) -> None:
        """Begin or end an exposure."""
        self._start, self._since_s, self._in_use = self.warmth(now), now, in_use

    def warmth(self, now: float) -> float:
        """Return how warm it is, from 0 (rested) to 1 (in use for long)."""
        final = float(self._in_use)
        return final + (self._start - final) * math.exp((self._since_s - now) / _WARM_UP_S)
