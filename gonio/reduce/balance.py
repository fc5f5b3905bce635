"""White balance under the light that was there: by the camera's channels, and by primaries."""

from __future__ import annotations

from dataclasses import dataclass
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


@dataclass(frozen=True)
class Balance:
    """From rates over those of the white reference to the BRDF in a space.

    The white's light may have another color than the one that the camera's matrix was made for.
    Two models tell what that does to colors; both are exact for grey. Scaling each channel of the
    camera is exact where filters are narrow (von Kries' rule). Scaling each primary of linear sRGB,
    into which the matrix unmixes them, is exact where filters are mixtures of these (spectral
    sharpening; Finlayson, Drew and Funt 1994). Cameras lie between, so a mean is taken.

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
    """

    by_channels: Array
    by_primaries: Array
    space_from_srgb: Array
    known: Array
    channels: Array

    @property
    def matrix(self) -> Array:
        """The mean of both, shape (3, 3)."""
        return self.by_channels + PRIMARIES * (self.by_primaries - self.by_channels)

    def relative(self, value: Array) -> Array:
        """Return rates over the white's for BRDFs in the space, shape (n, 3)."""
        return np.asarray(value @ np.linalg.inv(self.matrix).T)

    def model_sigma(self, value: Array) -> Array:
        """Return how well the mean of the models is known, shape (n, 3), for BRDFs.

        One figure for all channels of a value: where models agree by chance in one of them,
        cameras do not.
        """
        apart = self.relative(value) @ (self.by_primaries - self.by_channels).T
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
        lit = self.by_primaries is not self.by_channels
        return np.asarray((PRIMARIES - 1.0) * first - PRIMARIES * second if lit else -first)


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
    by_primaries = _by_primaries(coloring, rate, known)
    return Balance(
        by_channels,
        by_channels if by_primaries is None else by_primaries,
        coloring.space_from_srgb,
        known,
        channels,
    )


def _by_primaries(coloring: Coloring, rate: Array, known: Array) -> Array | None:
    """Return the matrix of the second model; None where the light's color is not told."""
    if coloring.neutral is None:
        return None
    to_srgb = np.linalg.inv(coloring.space_from_srgb)
    unmix = to_srgb @ np.linalg.inv(coloring.camera_from_space) / coloring.neutral
    light = unmix @ rate / (to_srgb @ known)
    if not (light > 0).all():
        return None
    return np.asarray(coloring.space_from_srgb @ (unmix * rate / light[:, None]))
