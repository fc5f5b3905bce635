"""The hemisphere seen from above: which directions were chosen, and which were skipped."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import to_spherical

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from matplotlib.projections.polar import PolarAxes
    from numpy.typing import ArrayLike

_RINGS_DEG = (30, 60)


def draw_hemisphere(axes: PolarAxes, chosen: ArrayLike, candidates: ArrayLike, title: str) -> None:
    """Draw directions as seen against the sample's normal, +x to the right.

    Parameters
    ----------
    axes
        Of a matplotlib figure, with `projection="polar"`. Radius is theta in degrees.
    chosen
        Unit vectors, shape (n, 3), drawn as filled discs.
    candidates
        Unit vectors, shape (m, 3), drawn as small open rings; those that were chosen lie under
        their discs.
    title
        What the directions are, such as "views: 14 of 81".
    """
    axes.scatter(*_polar(candidates), s=14, facecolors="none", edgecolors="0.6", linewidths=0.8)
    axes.scatter(*_polar(chosen), s=34, color="tab:blue", zorder=3)
    face_hemisphere(axes, title)


def face_hemisphere(axes: PolarAxes, title: str) -> None:
    """Label polar axes whose radius is theta in degrees, and whose angle is phi."""
    axes.set_rlim(0.0, 90.0)
    axes.set_rgrids(_RINGS_DEG, [f"{ring}°" for ring in _RINGS_DEG], angle=7.5)
    axes.tick_params(labelsize="x-small", colors="0.4")
    axes.grid(color="0.9")
    axes.set_title(title, fontsize="medium", pad=4)


def save_hemispheres(path: Path, chosen: Mapping[str, tuple[ArrayLike, ArrayLike]]) -> None:
    """Write a PNG with one hemisphere beside the other.

    Parameters
    ----------
    path
        The file, replaced if there.
    chosen
        Unit vectors that were chosen, shape (n, 3), and all that could be, (m, 3), by title.

    Raises
    ------
    gonio.errors.StorageError
        When it cannot be written.
    """
    from matplotlib.figure import Figure

    from gonio.files import write_with

    figure = Figure(figsize=(4.5 * len(chosen), 4.9), layout="constrained")
    every = figure.subplots(1, len(chosen), squeeze=False, subplot_kw={"projection": "polar"})
    for axes, (title, directions) in zip(every[0], chosen.items(), strict=True):
        draw_hemisphere(axes, *directions, title)
    # no software version in the file: the same plan gives the same bytes
    write_with(
        path,
        lambda aside: figure.savefig(aside, format="png", dpi=120, metadata={"Software": None}),
    )


def _polar(directions: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    theta, phi = to_spherical(np.asarray(directions, np.float64).reshape(-1, 3))
    return phi, np.degrees(theta)
