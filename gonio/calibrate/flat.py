"""The flat field: how much each pixel answers to the same radiance, vignetting included."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import CameraSpec


class FlatField:
    """Gathers frames of a known radiance.

    A pixel's response is the sum of its signals over the sum of what was expected, which is the
    most likely one where photons alone make noise.

    Parameters
    ----------
    spec
        The camera.
    channel
        0, 1 or 2 for each pixel's filter, shape (height, width).
    """

    def __init__(self, spec: CameraSpec, channel: NDArray[np.intp]) -> None:
        self._channel = channel
        self._signal, self._expected = np.zeros(channel.shape), np.zeros(channel.shape)
        x, y = spec.centre_px
        across, down = np.arange(spec.width) - x, np.arange(spec.height) - y
        square = across**2 + down[:, None] ** 2
        self._square = square / square.max()

    def add(
        self,
        signal: NDArray[np.float64],
        expected: NDArray[np.float64],
        seen: NDArray[np.bool_],
    ) -> None:
        """Add a frame, shapes (height, width).

        Parameters
        ----------
        signal
            Above dark and linear, in raw units.
        expected
            Exposure x radiance, in any unit.
        seen
            Which pixels saw the white reference and were not saturated.
        """
        self._signal[seen] += signal[seen]
        self._expected[seen] += expected[seen]

    def sigma(self, gain: float) -> float:
        """Return the relative uncertainty of a pixel's response by photon noise, the median.

        Parameters
        ----------
        gain
            Raw units per electron.
        """
        lit = self._signal[self._signal > 0]
        return float(np.median(np.sqrt(gain / lit))) if lit.size else 0.0

    def response(
        self, usable: NDArray[np.bool_]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        """Return each pixel's response, a smooth fit to it, and which were measured.

        Response and fit are 1 at the picture's centre, channel by channel. Where a pixel never
        saw the reference the fit stands in: 1 + a (r / R)^2 + b (r / R)^4 (Goldman 2010).

        Parameters
        ----------
        usable
            Which pixels may enter the fit, shape (height, width).
        """
        measured = self._expected > 0
        ratio = np.divide(self._signal, self._expected, where=measured, out=np.ones(measured.shape))
        smooth = np.ones(measured.shape)
        for channel in range(3):
            mine = self._channel == channel
            fitted = mine & measured & usable
            powers = np.stack([self._square**power for power in range(3)], axis=-1)
            terms, *_ = np.linalg.lstsq(powers[fitted], ratio[fitted])
            smooth[mine] = (powers[mine] @ terms) / terms[0]
            ratio[mine] /= terms[0]
        return np.where(measured, ratio, smooth), smooth, measured
