"""Dark frames: what the sensor says without light, and how much that varies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

_QUANTIZATION = 1.0 / 12.0


@dataclass(frozen=True)
class Dark:
    """The dark frames of one exposure.

    Attributes
    ----------
    mean
        Of each pixel, black level included, shape (height, width).
    read_variance
        Of a pixel from frame to frame, in raw units squared, the mean over all pixels.
    repeats
        How many frames there were.
    """

    mean: NDArray[np.float64]
    read_variance: float
    repeats: int

    @property
    def mean_variance(self) -> float:
        """Of a pixel of the mean."""
        return self.read_variance / self.repeats


def mean_dark(mosaics: Sequence[NDArray[np.uint16]]) -> Dark:
    """Average dark frames of one exposure, at least two, each of shape (height, width)."""
    stack = np.array(mosaics, np.float64)
    variance = float(stack.var(axis=0, ddof=1).mean())
    # a quiet sensor still rounds to whole numbers
    return Dark(stack.mean(axis=0), max(variance, _QUANTIZATION), len(stack))
