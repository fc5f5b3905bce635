"""What a scene asks for, as a picture: where light and eye are, and over half and difference."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from gonio.directions import to_half_difference, to_spherical
from gonio.report.hemisphere import face_hemisphere

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh
    from matplotlib.figure import Figure
    from matplotlib.projections.polar import PolarAxes
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_RINGS, _AZIMUTHS, _ANGLES = 18, 48, 45
_COLORS = "Blues"


def save_demand(path: Path, light: Array, view: Array, weight: Array) -> None:
    """Write a PNG of `draw_demand`.

    Parameters
    ----------
    path
        The file, replaced if there.

    Raises
    ------
    gonio.errors.StorageError
        When it cannot be written.
    """
    from gonio.files import write_with

    figure = draw_demand(light, view, weight)
    write_with(
        path,
        lambda aside: figure.savefig(aside, format="png", dpi=120, metadata={"Software": None}),
    )


def draw_demand(light: Array, view: Array, weight: Array) -> Figure:
    """Draw the demand for pairs of directions.

    Left and middle: where the light is and where the eye is, seen against the sample's normal, the
    marked edge to the right, as density per solid angle. Right: over the angle of the half vector
    to the normal and the angle of the light to the half vector.

    Parameters
    ----------
    light, view
        Unit vectors, shape (n, 3).
    weight
        How much each pair counts, shape (n,).
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.6, 4.6), layout="constrained")
    for place, (title, each) in enumerate({"light": light, "eye": view}.items(), start=1):
        axes = figure.add_subplot(1, 3, place, projection="polar")
        _draw_side(cast("PolarAxes", axes), each, weight, f"where the {title} is")
    axes = figure.add_subplot(1, 3, 3)
    mesh = _draw_angles(axes, light, view, weight)
    bar = figure.colorbar(mesh, ax=figure.axes, shrink=0.7, aspect=30)
    bar.set_ticks((0.0, 0.25, 1.0), labels=("none", "a quarter", "most"))
    bar.ax.tick_params(labelsize="x-small", colors="0.4")
    bar.outline.set_visible(False)
    return figure


def _draw_side(axes: PolarAxes, direction: Array, weight: Array, title: str) -> None:
    theta, phi = to_spherical(direction)
    rings = np.linspace(0.0, np.pi / 2, _RINGS + 1)
    azimuths = np.linspace(0.0, 2 * np.pi, _AZIMUTHS + 1)
    share, *_ = np.histogram2d(theta, phi, (rings, azimuths), weights=weight)
    # a ring's own cells are its solid angle; the pole's would be slivers, so they are one
    share[0] = share[0].mean()
    _draw_share(axes, azimuths, np.degrees(rings), share / -np.diff(np.cos(rings))[:, None])
    face_hemisphere(axes, title)


def _draw_angles(axes: Axes, light: Array, view: Array, weight: Array) -> QuadMesh:
    theta_h, _, theta_d, _ = to_half_difference(light, view)
    edges = np.linspace(0.0, 90.0, _ANGLES + 1)
    angles = (np.degrees(theta_d), np.degrees(theta_h))
    share, *_ = np.histogram2d(*angles, (edges, edges), weights=weight)
    mesh = _draw_share(axes, edges, edges, share)
    axes.set_aspect("equal")
    axes.set_xticks(range(0, 91, 30), [f"{tick}°" for tick in range(0, 91, 30)])
    axes.set_yticks(range(0, 91, 30), [f"{tick}°" for tick in range(0, 91, 30)])
    axes.tick_params(labelsize="x-small", colors="0.4")
    axes.spines[:].set_color("0.8")
    axes.set_xlabel("half vector to normal: 0° is a mirror's reflection", fontsize="small")
    axes.set_ylabel("light to half vector: 0° is light from the eye", fontsize="small")
    axes.set_title("over half and difference angle", fontsize="medium", pad=4)
    return mesh


def _draw_share(axes: Axes, columns: Array, rows: Array, share: Array) -> QuadMesh:
    """Draw shares of the most, their square roots as color: what is seldom shows, too."""
    from matplotlib.colors import PowerNorm

    color = PowerNorm(0.5, 0.0, 1.0)
    # thousands of cells would be large as paths in a page
    return axes.pcolormesh(
        columns, rows, share / share.max(), cmap=_COLORS, norm=color, rasterized=True
    )
