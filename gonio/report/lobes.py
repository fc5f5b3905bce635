"""Several materials in a plane of incidence: their lobes, over each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import from_spherical
from gonio.report.figures import SERIES, label_decades, literal, new_figure

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.figure import Figure

    from gonio.protocols import Material

_INCIDENCES_DEG = (0.0, 30.0, 60.0)
_VIEWS_DEG = np.linspace(-75.0, 75.0, 151)
_FLOOR = 1e-3
# axes of more decades overflow in matplotlib
_CEILING = 1e12


def draw_lobes(azimuth_deg: float, materials: Mapping[str, Material], white: float) -> Figure:
    """Draw BRDF against view angle within a plane, a picture an incidence, a line a material.

    Parameters
    ----------
    azimuth_deg
        Of the plane, on the side away from the light; there view angles are positive.
    materials
        By name; the first is dashed.
    white
        In 1/sr; lines are kept from a thousandth of it to 1e12 times it.
    """
    figure = new_figure(9.2, 3.0)
    axes = figure.subplots(1, len(_INCIDENCES_DEG), sharey=True)
    azimuth = np.radians(azimuth_deg)
    view = from_spherical(np.radians(_VIEWS_DEG), azimuth)
    for axis, theta_deg in zip(axes, _INCIDENCES_DEG, strict=True):
        light = from_spherical(np.radians(-theta_deg), azimuth)
        for number, (name, material) in enumerate(materials.items()):
            mean = material.evaluate(light, view).mean(axis=-1)
            mean = mean.clip(_FLOOR * white, _CEILING * white)
            color, _ = SERIES[number % len(SERIES)]
            style = (0, (3, 1.5)) if number == 0 else "-"
            axis.plot(
                _VIEWS_DEG, mean, color=color, linestyle=style, label=literal(name), linewidth=1.2
            )
        axis.set_title(f"light at {theta_deg:g}°", fontsize=8.5)
        axis.set_xticks([-60, -30, 0, 30, 60])
        axis.grid(axis="y", linewidth=0.6)
    axes[0].set_yscale("log")
    label_decades(axes[0].yaxis)
    axes[0].set_ylabel("BRDF, mean of channels (1/sr)")
    axes[1].set_xlabel("view angle (deg), positive away from the light")
    axes[-1].legend(fontsize=8)
    return figure
