"""Halo: light that the lens spreads about what is bright, seen in the dark room by the board."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.calibration import Halo

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_WIDTHS: Final = np.geomspace(0.015, 0.12, 30)
_FEWEST: Final = 50
# defocus softens the board's edge, and a pixel is not all on one side of it
_EDGE, _EDGE_PX = 0.01, 2.0
# a bell wants no more of them than that along a side
_CELLS: Final = 200


def halo_of(
    signals: Sequence[Array], away_px: Array, channel: NDArray[np.intp], veil: float
) -> Halo | None:
    """Return the bell that light is spread by, beside what is spread evenly.

    What the room's pixels say, less the veil, is proportional to the picture blurred by the bell.
    Of a row of widths the one that leaves least is taken.

    Parameters
    ----------
    signals
        Frames above dark and linear, each of shape (height, width).
    away_px
        How far each pixel looks past the board, 0 on it, shape (height, width).
    channel
        0, 1 or 2 for each pixel's filter, shape (height, width).
    veil
        Share of all light that is spread evenly.

    Returns
    -------
    Halo or None
        Sigma is by the scatter over channels; None where too little of the room is seen, or there
        is no halo to tell.
    """
    width = channel.shape[1]
    cell = 2 * max(1, round(width / _CELLS / 2))
    picture = np.mean(signals, axis=0)
    masks = [channel == each for each in range(3)]
    planes = [_cells(picture - veil * picture[mask].mean(), mask, cell) for mask in masks]
    room = _cells(away_px > max(_EDGE * width, _EDGE_PX), np.ones_like(masks[0]), cell) == 1.0
    if room.sum() < _FEWEST:
        return None
    fits = [_fit(planes, room, share * width / cell) for share in _WIDTHS]
    best = int(np.argmin([left for _, left in fits]))
    shares = fits[best][0]
    sigma = float(shares.std(ddof=1) / np.sqrt(len(shares)))
    if shares.mean() < 3.0 * sigma:
        return None
    return Halo(share=float(shares.mean()), sigma=sigma, width=float(_WIDTHS[best]))


def _fit(planes: Sequence[Array], room: NDArray[np.bool_], width: float) -> tuple[Array, float]:
    """Return each channel's share for a bell, and what it leaves, relative to what there was."""
    from scipy.ndimage import gaussian_filter

    # the room is dark: what is seen there spreads no further
    lit = [np.where(room, 0.0, plane) for plane in planes]
    spread = [gaussian_filter(plane, width, mode="reflect")[room] for plane in lit]
    seen = [plane[room] for plane in planes]
    shares = np.array([s @ b / (b @ b) for s, b in zip(seen, spread, strict=True)])
    left = [
        float(((s - share * b) ** 2).sum() / (s @ s))
        for s, b, share in zip(seen, spread, shares, strict=True)
    ]
    return shares, sum(left)


def _cells(values: NDArray[np.generic], mask: NDArray[np.bool_], cell: int) -> Array:
    """Return means over a mask's pixels in square cells, shape (height / cell, width / cell)."""
    rows, columns = (side // cell for side in mask.shape)
    where = np.s_[: rows * cell, : columns * cell]
    total, count = (
        each[where].reshape(rows, cell, columns, cell).sum(axis=(1, 3))
        for each in (np.where(mask, values, 0.0), mask.astype(np.float64))
    )
    return np.asarray(total / count)
