"""The twin's chip: everything that its pixels do but count and read out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim.pixels.dark_current import AMBIENT_C, dark_rate
from sim.pixels.fixed_pattern import FixedPattern
from sim.pixels.full_well import gathered

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sim.camera_imperfections import CameraImperfections


class Chip:
    """One sensor of its seed; without imperfections it changes nothing, to the bit.

    Parameters
    ----------
    shape
        Height and width in pixels.
    imperfections
        How large each is.
    seed
        Of the fixed pattern.
    """

    def __init__(
        self, shape: tuple[int, int], imperfections: CameraImperfections, seed: int
    ) -> None:
        self._sizes = imperfections
        self._pattern = FixedPattern.of(shape, imperfections, seed)

    def mean_electrons(
        self, light_e: NDArray[np.float64], exposure_s: float, warmth: float
    ) -> NDArray[np.float64]:
        """Return how many electrons are expected, shape (height, width).

        Parameters
        ----------
        light_e
            Those that a pixel of mean response makes of the light, shape (height, width).
        exposure_s
            How long the shutter was open.
        warmth
            Of the sensor, from 0 (rested) to 1 (in use for long).
        """
        sizes = self._sizes
        temperature_c = AMBIENT_C + sizes.camera_sensor_rise_c * warmth
        rate = dark_rate(temperature_c, sizes.camera_dark_e_per_s, sizes.camera_dark_doubling_c)
        mean: NDArray[np.float64] = (
            self._pattern.response * light_e + rate * exposure_s * self._pattern.dark
        )
        return mean

    def read(self, electrons: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what is read of the electrons that there truly were, shape (height, width)."""
        kept = gathered(electrons, self._sizes.camera_full_well)
        read: NDArray[np.float64] = kept + self._pattern.offset_e
        return read
