"""White balance under the light that was there: by the camera's channels, and by primaries."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.reduce.color import Coloring

    Array = NDArray[np.float64]

PRIMARIES: Final = 2.0 / 3.0
"""Weight of the balance by primaries in the mean of both."""

MODEL_SHARE: Final = 0.48
"""Standard uncertainty of that mean, as a share of the distance between both balances.

Measured cameras under lamps that change by a few percent (`make color`, docs/topics/color.md).
"""


_CHANNELS_ALONE: Final = 0.67
"""The same of the balance by channels."""


@dataclass(frozen=True)
class Balance:
    """From rates over those of the white reference to the BRDF in a space.

    The white's light may have another color than the one that the camera's matrix was made for.
    Two models tell what that does to colors; both are exact for grey. Scaling each channel of the
    camera is exact where filters are narrow (von Kries' rule). Scaling each primary of linear sRGB,
    into which the matrix unmixes them, is exact where filters are mixtures of these (spectral
    sharpening; Finlayson, Drew and Funt 1994). Cameras lie between, so a mean is taken, unless the
    light lacks a primary: then the second model says nothing of that one.

    Attributes
    ----------
    by_channels
        The first model's matrix, shape (3, 3): it maps (1, 1, 1) to the reference's BRDF.
    by_primaries
        The second's; that of the first where nothing tells the light's color.
    space_from_srgb
        As `gonio.reduce.color.Coloring` has it.
    known, channels
        The reference's BRDF in the space and in white-balanced camera RGB, 1/sr, shape (3,).
    lacking
        Primaries of linear sRGB that the light has none of, or less, shape (3,).
    """

    by_channels: Array
    by_primaries: Array
    space_from_srgb: Array
    known: Array
    channels: Array
    lacking: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(3, np.bool_))

    @property
    def matrix(self) -> Array:
        """The mean of both, shape (3, 3)."""
        return self.by_channels + self._weight * (self.by_primaries - self.by_channels)

    @property
    def _weight(self) -> float:
        return 0.0 if self.lacking.any() else PRIMARIES

    def relative(self, value: Array) -> Array:
        """Return rates over the white's for BRDFs in the space, shape (n, 3)."""
        return np.asarray(value @ np.linalg.inv(self.matrix).T)

    def model_sigma(self, value: Array) -> Array:
        """Return how well the mean of the models is known, shape (n, 3), for BRDFs.

        One figure for all channels of a value: where models agree by chance in one of them,
        cameras do not. Of a primary that the light lacks nothing is told: both the value and what
        is true are between black and the reference (JCGM 100:2008, 4.3.7).
        """
        apart = self.relative(value) @ (self.by_primaries - self.by_channels).T
        if self.lacking.any():
            to_srgb = np.linalg.inv(self.space_from_srgb)
            untold = self.lacking * (to_srgb @ self.known) / np.sqrt(3.0)
            variance = (_CHANNELS_ALONE * apart @ to_srgb.T) ** 2 + untold**2
            return np.asarray(np.sqrt(variance @ self.space_from_srgb.T**2))
        rms = np.sqrt((apart**2).mean(axis=-1, keepdims=True))
        return np.broadcast_to(MODEL_SHARE * rms, value.shape)

    def through_white(self, value: Array) -> Array:
        """Return how BRDFs change with relative errors of the white's rates, shape (n, 3, 3).

        By value, channel of the space and channel of the camera.
        """
        relative = self.relative(value)
        first = self.by_channels * relative[:, None, :]
        to_srgb = np.linalg.inv(self.space_from_srgb)
        shares = (to_srgb @ self.by_primaries) / (to_srgb @ self.known)[:, None]
        # each primary is divided by what the white's rates say of it
        primaries = relative @ (to_srgb @ self.by_primaries).T
        second = self.space_from_srgb @ (shares * primaries[..., None])
        weight = self._weight if self.by_primaries is not self.by_channels else 0.0
        return np.asarray((weight - 1.0) * first - weight * second)


def balance(coloring: Coloring, rate: Array, known: Array) -> Balance:
    """Return the balance for a white reference that gave some rates.

    Parameters
    ----------
    coloring
        The camera and the space.
    rate
        Of the white reference, in any unit, shape (3,).
    known
        Its BRDF in the space, shape (3,).
    """
    channels = coloring.camera_from_space @ known
    by_channels = np.linalg.inv(coloring.camera_from_space) * channels
    plain = Balance(by_channels, by_channels, coloring.space_from_srgb, known, channels)
    return plain if coloring.neutral is None else _with_primaries(plain, coloring, rate)


def _with_primaries(plain: Balance, coloring: Coloring, rate: Array) -> Balance:
    """Return a balance with the second model, where the light's color is told."""
    to_srgb = np.linalg.inv(coloring.space_from_srgb)
    unmix = to_srgb @ np.linalg.inv(coloring.camera_from_space) / coloring.neutral
    light = unmix @ rate / (to_srgb @ plain.known)
    there = light > 0
    by_primaries = to_srgb @ plain.by_channels
    by_primaries[there] = (unmix * rate)[there] / light[there, None]
    by_primaries = coloring.space_from_srgb @ by_primaries
    return replace(plain, by_primaries=by_primaries, lacking=~there)
