"""What each cause of uncertainty does to the rates, carried from there to samples."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.reduce.doubt import Doubt
    from gonio.reduce.merge import Rate
    from gonio.reduce.reading import Reading
    from gonio.reduce.white import Response

    Array = NDArray[np.float64]

_NOISE: Final = ("photon", "read", "dark")


@dataclass(frozen=True)
class Causes:
    """Carries causes by name from rates of samples and of the white reference to a space.

    Names are `photon`, `read` and `dark` for one sigma of such noise, `level` for one raw unit in
    every frame, `surround` and `around` for a share of one of stray light and halo, and `spread`
    for a relative error of one in each frame by itself.

    Attributes
    ----------
    response
        What the white frames told.
    value
        The samples' BRDF in the space, 1/sr, shape (n, 3).
    rates, brackets
        What each sample was made from.
    doubt
        How well the sensor's correction is known.
    """

    response: Response
    value: Array
    rates: Sequence[Rate]
    brackets: Sequence[Sequence[Reading]]
    doubt: Doubt

    def independent(self, name: str) -> Array:
        """Return sigma for a cause that errs in each camera channel by itself, shape (n, 3)."""
        return self.response.sigma_in_space((self._of_samples[name] / self._scale) ** 2)

    def common(self, name: str) -> Array:
        """Return the signed error for a cause that samples and white frames share, shape (n, 3)."""
        of_samples = self.response.in_space(self._of_samples[name] / self._scale)
        return of_samples + self._by_white(self._of_white[name] / self.response.rate.value)

    def white_noise(self) -> Array:
        """Return sigma for the noise of the white frames, shape (n, 3)."""
        relative = self.response.rate.variance / self.response.rate.value**2
        return np.asarray(np.sqrt(self._through_white**2 @ relative))

    def calibration(self) -> Array:
        """Return sigma for the sensor's correction, shape (n, 3).

        The pixels of sample and white reference count as other ones, whose responses err by
        themselves. What bends and what lamps do to both cancels.
        """
        pixels, of_white = (self._pixels(bracket) for bracket in (self.brackets, [self._whites]))
        squares = self.response.sigma_in_space(self.camera**2 * self.doubt.flat**2 / pixels) ** 2
        squares += self._through_white**2 @ (self.doubt.flat**2 / of_white[0])
        squares += sum((self._bent(each) ** 2 for each in self.doubt.bends), np.zeros(1))
        return np.sqrt(squares + self._lamps() ** 2)

    def frame_by_frame(self) -> tuple[Array, float]:
        """Return what is left of a relative error of one: of samples, shape (n, 3), of the white.

        All channels of a frame err alike.
        """
        of_samples = self.response.in_space(self._of_samples["spread"] * self.camera)
        return np.abs(of_samples), float(self._of_white["spread"].max())

    def shutter(self) -> Array:
        """Return what a relative error of one in each exposure's time does, shape (n, 3).

        Frames of one exposure err alike, so what samples and white frames both weigh cancels.
        """
        times = {r.exposure_s for each in (*self.brackets, self._whites) for r in each}
        squares = np.zeros(self.value.shape)
        for time in sorted(times):
            of_samples = [
                _of_time(time, *pair) for pair in zip(self.rates, self.brackets, strict=True)
            ]
            of_white = _of_time(time, self.response.rate, self._whites)
            shifted = self.response.in_space(np.array(of_samples) * self.camera)
            squares += (shifted + self._by_white(of_white)) ** 2
        return np.sqrt(squares)

    def fading(self) -> Array:
        """Return how far the lamps' flux is from that of the white frames, relative, shape (n,)."""
        return faded(self._mean_of("flux", self.brackets), self._mean_of("flux", [self._whites])[0])

    @property
    def _whites(self) -> Sequence[Reading]:
        return self.response.readings

    @staticmethod
    def _pixels(brackets: Sequence[Sequence[Reading]]) -> Array:
        """Return how many pixels each bracket has in its smallest patch, shape (n, 3)."""
        return np.array([np.min([r.pixels for r in each], axis=0) for each in brackets], np.float64)

    @staticmethod
    def _mean_of(name: str, brackets: Sequence[Sequence[Reading]]) -> Array:
        """Return the mean of a reading's field over each bracket, shape (n, ...)."""
        return np.array([np.mean([getattr(r, name) for r in each], axis=0) for each in brackets])

    def _bent(self, coefficients: Array) -> Array:
        """Return the signed error for an error of the linearity's coefficients, shape (n, 3)."""
        one = replace(self.doubt, bends=coefficients[None])
        of_samples = [_bending(one, *pair) for pair in zip(self.rates, self.brackets, strict=True)]
        of_white = _bending(one, self.response.rate, self._whites)
        shifted = self.response.in_space(np.array(of_samples) / self._scale)
        return shifted + self._by_white(of_white / self.response.rate.value)

    def _lamps(self) -> Array:
        """Return sigma for the lamps' strengths, shape (n, 3)."""
        shares, of_white = (
            self._mean_of("lamps", each) for each in (self.brackets, [self._whites])
        )
        relative = np.linalg.norm((shares - of_white) * self.doubt.lamps, axis=1)
        return self.response.in_space(self.camera * relative[:, None])

    def _by_white(self, relative: Array) -> Array:
        """Return the signed error for relative errors of the white's rates, shape (n, 3)."""
        return np.asarray(self._through_white @ relative)

    @cached_property
    def _through_white(self) -> Array:
        return self.response.balance.through_white(self.value)

    @property
    def camera(self) -> Array:
        """The samples in white-balanced camera channels, 1/sr, shape (n, 3)."""
        return np.asarray(self.value @ self.response.camera_from_space.T)

    @property
    def _scale(self) -> Array:
        return self.response.rate_per_brdf

    @cached_property
    def _of_samples(self) -> dict[str, Array]:
        each = [_effects(*pair) for pair in zip(self.rates, self.brackets, strict=True)]
        return {name: np.array([effects[name] for effects in each]) for name in each[0]}

    @cached_property
    def _of_white(self) -> dict[str, Array]:
        return _effects(self.response.rate, self.response.readings)


def faded(flux: Array, of_white: Array) -> Array:
    """Return how far lamps' flux is from what it was in white frames, relative, shape (n,).

    Lamp by lamp, each for its share of the light: one that fades while another brightens leaves
    their sum as it was, and not their color. One that was dark then is compared with the mean.

    Parameters
    ----------
    flux, of_white
        Of each lamp, shapes (n, 11) and (11,).
    """
    before = np.where(of_white > 0, of_white, of_white.mean(where=of_white > 0))
    change = np.abs(np.log(np.where(flux > 0, flux / before, 1.0)))
    return np.asarray((flux * change).sum(axis=1) / flux.sum(axis=1))


def _of_time(time: float, rate: Rate, bracket: Sequence[Reading]) -> Array:
    """Return the weight of all readings of one time of exposure, shape (3,)."""
    of_it = [reading.exposure_s == time for reading in bracket]
    return np.asarray(rate.weights[of_it].sum(axis=0))


def _bending(doubt: Doubt, rate: Rate, bracket: Sequence[Reading]) -> Array:
    """Return what the one error of linearity in `doubt` does to a rate, shape (3,)."""
    as_read = np.array([reading.as_read for reading in bracket])
    return np.asarray((rate.per_signal * as_read * doubt.bending(as_read)[0]).sum(axis=0))


def _effects(rate: Rate, bracket: Sequence[Reading]) -> dict[str, Array]:
    """Return what one unit of each cause does to a rate, shape (3,) each."""
    surround, around = (np.array([getattr(r, n) for r in bracket]) for n in ("surround", "around"))
    return {
        **{name: np.sqrt(getattr(rate, name)) for name in _NOISE},
        "level": rate.per_signal.sum(axis=0),
        "surround": (rate.per_signal * surround).sum(axis=0),
        "around": (rate.per_signal * around).sum(axis=0),
        # how much of a relative error of single frames is left in their weighted mean
        "spread": np.sqrt((rate.weights**2).sum(axis=0)),
    }
