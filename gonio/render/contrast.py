"""Pictures as a person sees them, and how far one is from another."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nnbrdf.difference import psnr_db
from nnbrdf.sphere import tone_map

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from gonio.render.shading import Picture

# what a camera's meter takes a scene to reflect
_MIDDLE_GREY = 0.18


class Contrast(NamedTuple):
    """How far a picture is from that of the reference, over the pixels that the shape covers.

    Attributes
    ----------
    steps
        Absolute difference, mean of the channels, in 8-bit steps, NaN beside the shape,
        shape (size, size).
    mean
        Of the steps.
    psnr_db
        Infinite where pictures are identical.
    """

    steps: NDArray[np.float64]
    mean: float
    psnr_db: float

    @property
    def psnr(self) -> str:
        """The ratio in words."""
        return "identical" if np.isinf(self.psnr_db) else f"{self.psnr_db:.1f} dB"


def exposure(reference: Iterable[Picture], stops: float = 0.0) -> float:
    """Return what to multiply pictures by, as a camera meters: their mean becomes 18 %.

    Parameters
    ----------
    reference
        All pictures of the material that the others are held against.
    stops
        Brighter by so many doublings.
    """
    pictures = list(reference)
    light = sum(float(picture.color.mean(axis=-1).sum()) for picture in pictures)
    area = sum(float(picture.cover.sum()) for picture in pictures)
    return _MIDDLE_GREY * area / light * 2.0**stops if light > 0 else 1.0


def developed(picture: Picture, factor: float) -> NDArray[np.uint8]:
    """Return 8-bit sRGB with highlights rolled off, shape (size, size, 3), before black."""
    return tone_map(factor * picture.color)


def contrast(picture: Picture, reference: Picture, factor: float) -> Contrast:
    """Compare two pictures of one shape, both developed alike."""
    whole = reference.cover >= 1.0
    one, other = developed(picture, factor), developed(reference, factor)
    steps = np.where(whole, np.abs(one.astype(np.float64) - other).mean(axis=-1), np.nan)
    # squares would cost a dark material nothing beside black, so that is left out
    return Contrast(steps, float(steps[whole].mean()), psnr_db(one[whole], other[whole]))


def scale_of(contrasts: Iterable[Contrast]) -> float:
    """Return the steps at which the colors of difference pictures end: a round number for all.

    It fits the middle one of them; a poor material is shown at its end, a good one not as black.
    """
    most = float(np.median([np.nanpercentile(each.steps, 99.0) for each in contrasts]))
    rounds = [float(digit * 10**power) for power in (0, 1, 2) for digit in (1, 2, 5)]
    return next((each for each in rounds if each >= most), 255.0)


def on_paper(
    picture: NDArray[np.uint8], cover: NDArray[np.float64], paper: float = 1.0
) -> NDArray[np.float64]:
    """Return sRGB from 0 to 1, the picture before paper of an even grey."""
    color: NDArray[np.float64] = picture / 255.0
    return np.clip(color + paper * (1.0 - cover[..., None]), 0.0, 1.0)
