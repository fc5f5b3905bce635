"""How well a correction of the sensor is known, and what that does to signals."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.calibration import CalibrationDocument

_LAMPS: Final = 11
# no halo is a bell: what is taken off is believed to a fifth
_HALO_SHAPE: Final = 0.2


@dataclass(frozen=True)
class Doubt:
    """Standard uncertainties of a correction; without arguments, of one that corrects nothing.

    Attributes
    ----------
    flat
        Of a single pixel's response, relative; pixels err by themselves.
    bends
        Errors of the linearity's coefficients that occur independently, one sigma each, shape
        (n, degree).
    raw_range
        In raw units, which the linearity is a function of the share of.
    reach
        The share of the range beyond which the bending, and its error, stay as they are.
    lamps
        Of each lamp's strength, relative, shape (11,).
    stray_light, halo
        Of the shares of stray light and of the halo.
    """

    flat: float = 0.0
    bends: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 1)))
    raw_range: float = 1.0
    reach: float = np.inf
    lamps: NDArray[np.float64] = field(default_factory=lambda: np.zeros(_LAMPS))
    stray_light: float = 0.0
    halo: float = 0.0

    @classmethod
    def of(cls, document: CalibrationDocument) -> Doubt:
        """Return what a calibration says of itself; older ones say less."""
        lamps = np.zeros(_LAMPS)
        for lamp in document.lamps:
            lamps[lamp.n - 1] = lamp.sigma / lamp.strength
        errors = document.linearity.errors
        halo = document.stray_light.halo if document.stray_light else None
        return cls(
            flat=document.flat_sigma,
            bends=np.array(errors).reshape(len(errors), len(document.linearity.coefficients)),
            raw_range=document.linearity.raw_range,
            reach=document.linearity.reach,
            lamps=lamps,
            stray_light=document.stray_light.sigma if document.stray_light else 0.0,
            halo=float(np.hypot(halo.sigma, _HALO_SHAPE * halo.share)) if halo else 0.0,
        )

    def bending(self, signal: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return by which share of itself a signal errs for each of `bends`.

        Parameters
        ----------
        signal
            Above dark as it was read, in raw units, shape (...).

        Returns
        -------
        ndarray
            Signed, shape (n, ...).
        """
        powers = np.arange(1, self.bends.shape[1] + 1)
        share = np.clip(np.asarray(signal)[..., None] / self.raw_range, None, self.reach)
        return np.moveaxis((share**powers) @ self.bends.T, -1, 0)
