"""A bracket merged pixel by pixel into light and its variance, never demosaiced."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.reduce.merge import weigh

try:
    from gonio import _pixels
except ImportError:
    _pixels = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.calibration import Linearity

# so many at a time that they stay in the processor's cache
_ROWS = 32


@dataclass(frozen=True)
class Exposed:
    """One frame of a bracket.

    Attributes
    ----------
    mosaic, dark
        Raw values, and what is to be taken off them, shape (height, width) each.
    exposure
        What a pixel of response 1 gathered, in whatever unit, such as seconds.
    read_variance
        Of a pixel without light, the dark frame's share included, in raw units squared.
    stray
        Stray light at each place of the 2 x 2 cell, row by row, in raw units.
    """

    mosaic: NDArray[np.uint16]
    dark: NDArray[np.float32]
    exposure: float
    read_variance: float
    stray: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Pixels:
    """What makes raw values of light.

    Attributes
    ----------
    gain
        Raw units per electron.
    saturation
        The raw value from which a pixel says nothing.
    linearity
        How raw values bend; None: they do not.
    response
        Of each pixel, shape (height, width), NaN for one to leave out; None: all are alike.
    """

    gain: float
    saturation: float
    linearity: Linearity | None = None
    response: NDArray[np.float32] | None = None


@dataclass(frozen=True)
class Radiance:
    """Light of each pixel, shapes (height, width); NaN for one to leave out.

    Attributes
    ----------
    value
        Raw units of a linear sensor over exposure. Of a clipped pixel what the shortest exposure
        says, a lower bound.
    variance
        In that unit squared; infinite where clipped, so that nobody weighs it.
    """

    value: NDArray[np.float32]
    variance: NDArray[np.float32]

    @property
    def clipped(self) -> NDArray[np.bool_]:
        """Whether every exposure was saturated."""
        return np.isinf(self.variance)


def merge_pixels(bracket: Sequence[Exposed], pixels: Pixels) -> Radiance:
    """Merge a bracket by the weights of `gonio.reduce.merge.weigh`, each pixel by itself.

    Parameters
    ----------
    bracket
        At least one frame, in whatever order.
    pixels
        The sensor's.
    """
    if _pixels is not None:
        return _merge_compiled(bracket, pixels)
    value = np.empty(bracket[0].mosaic.shape, np.float32)
    variance = np.empty_like(value)
    for start in range(0, len(value), _ROWS):
        rows = slice(start, start + _ROWS)
        value[rows], variance[rows] = _merge_rows(bracket, pixels, rows)
    return Radiance(value, variance)


def _merge_compiled(bracket: Sequence[Exposed], pixels: Pixels) -> Radiance:
    bending = pixels.linearity
    value, variance = _pixels.merge(
        [
            (frame.mosaic, frame.dark, frame.exposure, frame.read_variance, frame.stray)
            for frame in bracket
        ],
        pixels.response,
        bending.coefficients if bending else (),
        bending.raw_range if bending else 1.0,
        bending.reach if bending else 1.0,
        pixels.gain,
        pixels.saturation,
    )
    return Radiance(value, variance)


def _merge_rows(
    bracket: Sequence[Exposed], pixels: Pixels, rows: slice
) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    shape = bracket[0].mosaic[rows].shape
    stray = np.array([_over(frame.stray, shape, rows.start) for frame in bracket])
    above = np.array(
        [frame.mosaic[rows] - frame.dark[rows].astype(np.float64) for frame in bracket]
    )
    signal = (pixels.linearity.undo(above) if pixels.linearity else above) - stray
    response = np.ones(shape) if pixels.response is None else pixels.response[rows]
    exposure = np.array([frame.exposure * response for frame in bracket])
    saturated = np.array([frame.mosaic[rows] >= pixels.saturation for frame in bracket])
    read = np.array([[[frame.read_variance]] for frame in bracket])
    found = weigh(signal, exposure, saturated, read + pixels.gain * stray.clip(0.0), pixels.gain)
    variance = np.where(found.clipped & ~np.isnan(response), np.inf, 1.0 / found.certainty)
    return (found.per_signal * signal).sum(axis=0), variance


def _over(cell: tuple[float, ...], shape: tuple[int, ...], first: int) -> NDArray[np.float64]:
    """Repeat a 2 x 2 cell over some rows of a mosaic."""
    rows, columns = np.ogrid[first : first + shape[0], : shape[1]]
    return np.asarray(np.reshape(cell, (2, 2))[rows % 2, columns % 2], np.float64)
