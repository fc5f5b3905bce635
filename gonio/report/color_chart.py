"""The shot of a color chart: where its patches were read, and how each looks by the matrix."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.chart import places
from gonio.color import XYZ_FROM_SRGB
from gonio.colorimetry.detection import patch_outlines
from gonio.files import write_with
from gonio.reduce.picture import color_picture_of
from nnbrdf.sphere import encode_srgb

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gonio.colorimetry.color_file import ChartMatrix
    from gonio.reduce.raw import RawFrame

_HALF = 0.45


def write_color_chart(
    path: Path, raw: RawFrame, homography: NDArray[np.float64], chart: ChartMatrix
) -> None:
    """Draw the frame with the outlines of what was read, and each patch beside its reference.

    Parameters
    ----------
    path
        A PNG file, written whole or not at all.
    raw, homography
        The frame, and where the chart is in it.
    chart
        What was found.

    Raises
    ------
    gonio.errors.StorageError
        When the file cannot be written.
    """
    figure = _figure(raw, homography, chart)
    write_with(path, lambda aside: figure.savefig(aside, format="png"))


def _figure(raw: RawFrame, homography: NDArray[np.float64], chart: ChartMatrix) -> Figure:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 4.6), dpi=120, layout="constrained")
    frame, patches = figure.subplots(1, 2, width_ratios=(1.0, 1.35))
    _draw_frame(frame, raw, homography)
    _draw_patches(patches, chart)
    return figure


def _draw_frame(axes: Axes, raw: RawFrame, homography: NDArray[np.float64]) -> None:
    height, width = raw.mosaic.shape
    axes.imshow(color_picture_of(raw)[..., ::-1], extent=(-0.5, width - 0.5, height - 0.5, -0.5))
    for outline in patch_outlines(homography):
        axes.fill(*outline.T, fill=False, edgecolor="tab:red", linewidth=0.8)
    axes.set_title("as the camera sees it, and what was read", fontsize=9)
    axes.set_axis_off()


def _draw_patches(axes: Axes, chart: ChartMatrix) -> None:
    """Draw each patch as found, in its middle as it should be, with its CIEDE2000 below."""
    for (column, row), patch in zip(places(), chart.patches, strict=True):
        for half, xyz in ((_HALF, patch.found), (_HALF / 2.0, patch.reference)):
            x, y = column + half * np.array([-1, 1, 1, -1]), row + half * np.array([-1, -1, 1, 1])
            axes.fill(x, y, color=_shown(xyz), linewidth=0)
        dark = patch.reference[1] < 0.25
        axes.text(
            column, row + 0.9 * _HALF, f"{patch.delta_e:.2f}", fontsize=7, ha="center",
            color="white" if dark else "black",
        )  # fmt: skip
    axes.set_xlim(-0.5, 5.5)
    axes.set_ylim(3.5, -0.5)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title(
        f"by the matrix, in the middle as it should be; CIEDE2000, mean {chart.delta_e.mean():.2f}",
        fontsize=9,
    )


def _shown(xyz: tuple[float, float, float]) -> NDArray[np.float64]:
    return np.asarray(encode_srgb(np.linalg.inv(XYZ_FROM_SRGB) @ np.array(xyz)), np.float64)
