"""A picture of the sample as measured and as the networks of its texels tell it, as PNG."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.files import write_with
from nnbrdf.sphere import encode_srgb

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

_MOST_TEXELS = 512
_BRIGHT = 0.8
_MAGNIFIED = 5.0


def write_relit(path: Path, measured: NDArray[np.float64], relit: NDArray[np.float64]) -> None:
    """Draw both and five times their difference, the middle of large ones; whole or not at all.

    Parameters
    ----------
    path
        A PNG file.
    measured, relit
        BRDF in 1/sr, linear sRGB, shape (side, side, 3); NaN where nothing was seen.

    Raises
    ------
    gonio.errors.StorageError
        When the file cannot be written.
    """
    write_with(path, lambda aside: _figure(measured, relit).savefig(aside, format="png"))


def _figure(measured: NDArray[np.float64], relit: NDArray[np.float64]) -> Figure:
    from matplotlib.figure import Figure

    middle = _middle(len(measured))
    measured, relit = measured[middle, middle], relit[middle, middle]
    scale = _BRIGHT / max(float(np.nanquantile(measured, 0.99)), 1e-9)
    pictures = {
        "measured, held out": measured,
        "relit": relit,
        f"difference x {_MAGNIFIED:g}": _MAGNIFIED * np.abs(relit - measured),
    }
    figure = Figure(figsize=(10.5, 3.8), dpi=120, layout="constrained")
    for axis, (title, picture) in zip(figure.subplots(1, 3), pictures.items(), strict=True):
        axis.set_axis_off()
        axis.set_title(title)
        shown = encode_srgb(scale * np.nan_to_num(picture).astype(np.float64))
        axis.imshow(shown, interpolation="nearest")
    return figure


def _middle(side: int) -> slice:
    first = max(0, (side - _MOST_TEXELS) // 2)
    return slice(first, first + _MOST_TEXELS)
