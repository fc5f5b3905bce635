"""What a normal distribution of the logarithm says of the value."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.prior.log import OFFSET

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_Z95 = 1.6448536269514722
_LARGEST = 50.0


@dataclass(frozen=True)
class LogNormal:
    """ln(value / scale + 0.01) is normal; the value itself is never below zero.

    Attributes
    ----------
    mean, deviation
        Of the logarithm, of one shape.
    scale
        In 1/sr.
    """

    mean: Array
    deviation: Array
    scale: float

    @property
    def median(self) -> Array:
        """The median in 1/sr."""
        return self._value(self.mean)

    @property
    def sigma(self) -> Array:
        """Half the distance of the 16 and 84 % quantiles, in 1/sr, before they are cut at zero.

        The standard deviation of a log-normal is all tail where the logarithm is uncertain.
        """
        spread = np.sinh(self.deviation.clip(max=_LARGEST))
        return np.asarray(self.scale * np.exp(self.mean.clip(max=_LARGEST)) * spread)

    @property
    def quantiles(self) -> tuple[Array, Array]:
        """The 5 and 95 % quantiles in 1/sr."""
        reach = _Z95 * self.deviation
        return self._value(self.mean - reach), self._value(self.mean + reach)

    def _value(self, log: Array) -> Array:
        return np.asarray(self.scale * (np.exp(log.clip(max=_LARGEST)) - OFFSET).clip(0.0))
