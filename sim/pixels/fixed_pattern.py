"""Fixed-pattern noise: how pixels differ, the same in every frame of a sensor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sim.sensor import keyed_generator

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sim.camera_imperfections import CameraImperfections

# stands for a frame of zeros
_NOTHING = np.zeros((1, 1))


@dataclass(frozen=True)
class FixedPattern:
    """How the pixels of one sensor differ (terms of EMVA Standard 1288).

    Each is of shape (height, width), or of one that broadcasts to it.

    Attributes
    ----------
    response
        PRNU: electrons a pixel makes of the light for one, the mean over all is 1.
    offset_e
        DSNU and the columns' amplifiers: electrons that a pixel reads too high, whatever the
        exposure; their mean is 0.
    dark
        Dark current of a pixel for one, 1 but for hot pixels.
    """

    response: NDArray[np.float64]
    offset_e: NDArray[np.float64]
    dark: NDArray[np.float64]

    @classmethod
    def of(cls, shape: tuple[int, int], sizes: CameraImperfections, seed: int) -> FixedPattern:
        """Draw the pattern of the sensor with that seed, of shape (height, width)."""
        pixel = _spread(shape, sizes.camera_dsnu_e, keyed_generator(seed, "dsnu"))
        column = _spread((1, shape[1]), sizes.camera_column_e, keyed_generator(seed, "columns"))
        return cls(
            response=1.0 + _spread(shape, sizes.camera_prnu, keyed_generator(seed, "prnu")),
            offset_e=pixel + column,
            dark=1.0 + _heat(shape, sizes, keyed_generator(seed, "hot pixels")),
        )


def _spread(
    shape: tuple[int, int], size: float, random: np.random.Generator
) -> NDArray[np.float64]:
    """Return normal values with that standard deviation and a mean of 0."""
    if size == 0.0:
        return _NOTHING
    values = random.standard_normal(shape)
    spread: NDArray[np.float64] = size * (values - values.mean())
    return spread


def _heat(
    shape: tuple[int, int], sizes: CameraImperfections, random: np.random.Generator
) -> NDArray[np.float64]:
    """Return by how many times of it hot pixels exceed the dark current: few by very much."""
    if sizes.camera_hot_share == 0.0:
        return _NOTHING
    hot = random.random(shape) < sizes.camera_hot_share
    heat: NDArray[np.float64] = sizes.camera_hot_times * hot * random.standard_exponential(shape)
    return heat
