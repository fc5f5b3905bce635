"""Photon transfer: raw units per electron, from how the noise of the white frames grows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.reduce.dark import Dark


_HOT_SHARE = 0.01


class PhotonTransfer:
    """Gathers repeats of an evenly lit scene and tells the gain.

    The variance of a pixel from repeat to repeat is gain x signal + read variance, in raw units
    (Janesick, Photon Transfer, 2007, chapter 5), so the gain is the sum of all excess variances
    over the sum of all signals, which no unevenness of the light can disturb. Exposures that
    saturate more than a few hot pixels count only where there are no others: of pixels at the limit
    those that stay below it in every repeat are the less noisy ones.
    """

    def __init__(self) -> None:
        self._whole, self._partly = np.zeros(2), np.zeros(2)

    def add(self, mosaics: Sequence[NDArray[np.uint16]], dark: Dark, saturation: float) -> None:
        """Add repeats of one exposure, each of shape (height, width); one alone tells nothing."""
        if len(mosaics) < 2:
            return
        stack = np.array(mosaics)
        usable = (stack < saturation).all(axis=0)
        signal = stack[:, usable] - dark.mean[usable]
        level = signal.mean(axis=1) if usable.any() else np.zeros(len(stack))
        if level.min() < 10.0 * np.sqrt(dark.read_variance):
            return
        # shutter and lamps vary from frame to frame, by more than photons do: take that out
        signal *= (level.mean() / level)[:, None]
        sums = self._whole if usable.mean() > 1.0 - _HOT_SHARE else self._partly
        sums += (
            (signal.var(axis=0, ddof=1) - dark.read_variance).sum(), signal.mean(axis=0).sum()
        )  # fmt: skip

    @property
    def gain(self) -> float:
        """Raw units per electron.

        Raises
        ------
        gonio.errors.BadInputError
            When nothing was bright enough, or the noise does not grow with the signal.
        """
        excess, signal = self._whole if self._whole[1] else self._partly
        if not excess > 0:
            raise BadInputError(
                "the white frames' noise does not tell the camera's gain: two repeats that are "
                "bright and not saturated are needed; check the lamps and exposures_s, and capture "
                "again"
            )
        return float(excess / signal)
