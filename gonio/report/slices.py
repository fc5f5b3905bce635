"""The BRDF in a plane of incidence: what a goniometer's user looks at first."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import from_spherical
from gonio.report.figures import ACCENT, CHANNELS, TRUTH, label_decades, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gonio.protocols import Estimate, Material
    from gonio.samples import Samples

INCIDENCES_DEG = (0.0, 30.0, 60.0)
_COLORS = (CHANNELS[1], ACCENT, TRUTH)
_VIEWS_DEG = np.linspace(-75.0, 75.0, 151)
_NEAR_DEG = 3.0
_FLOOR = 1e-3


def draw_slice(
    azimuth_deg: float, estimate: Estimate, truth: Material | None, samples: Samples
) -> Figure:
    """Draw BRDF against view angle within the plane of incidence, mean of the channels.

    Parameters
    ----------
    azimuth_deg
        Of the plane, on the side away from the light; there view angles are positive.
    estimate, truth
        Drawn as a line with its 5 to 95 % band, and dashed.
    samples
        Those within 3 deg of the plane and of a drawn incidence are drawn as dots.
    """
    figure = new_figure(4.6, 3.4)
    axes = figure.subplots()
    for theta_deg, color in zip(INCIDENCES_DEG, _COLORS, strict=True):
        light, view = (_in_plane(t, azimuth_deg) for t in (-theta_deg, _VIEWS_DEG))
        _draw_estimate(axes, estimate, light, view, samples.white, color)
        axes.lines[-1].set_label(f"light at {theta_deg:g}°")
        if truth is not None:
            true = _mean(truth.evaluate(light, view), samples.white)
            axes.plot(_VIEWS_DEG, true, color=color, linestyle=(0, (3, 1.5)), linewidth=1.0)
        _draw_samples(axes, samples, light, azimuth_deg, color)
    axes.set_yscale("log")
    label_decades(axes.yaxis)
    axes.set_xticks(np.arange(-75, 76, 25))
    axes.grid(axis="y", linewidth=0.6)
    axes.set_xlabel("view angle (deg), positive away from the light")
    axes.set_ylabel("BRDF, mean of channels (1/sr)")
    axes.legend(fontsize=8)
    return figure


def has_samples(azimuth_deg: float, samples: Samples) -> bool:
    """Tell whether `draw_slice` has samples to draw."""
    lights = (_in_plane(-theta_deg, azimuth_deg) for theta_deg in INCIDENCES_DEG)
    return any(_near(samples, light, azimuth_deg).any() for light in lights)


def _in_plane(angle_deg: float | NDArray[np.float64], azimuth_deg: float) -> NDArray[np.float64]:
    return from_spherical(np.radians(angle_deg), np.radians(azimuth_deg))


def _mean(value: NDArray[np.float64], white: float) -> NDArray[np.float64]:
    """Return the mean of the channels, kept above what a logarithmic axis need not show."""
    mean: NDArray[np.float64] = value.mean(axis=-1).clip(_FLOOR * white)
    return mean


def _draw_estimate(
    axes: Axes, estimate: Estimate, light: NDArray[np.float64], view: NDArray[np.float64],
    white: float, color: str,
) -> None:  # fmt: skip
    # as if the channels erred together: the band of their mean is then the mean of their bands
    low, high = (_mean(bound, white) for bound in estimate.quantiles(light, view))
    axes.fill_between(_VIEWS_DEG, low, high, color=color, alpha=0.18, linewidth=0)
    axes.plot(_VIEWS_DEG, _mean(estimate.evaluate(light, view), white), color=color)


def _draw_samples(
    axes: Axes, samples: Samples, light: NDArray[np.float64], azimuth_deg: float, color: str
) -> None:
    near, along = _near(samples, light, azimuth_deg), _in_plane(90.0, azimuth_deg)
    view = samples.view[near]
    angle_deg = np.degrees(np.arctan2(view @ along, view[:, 2]))
    axes.plot(angle_deg, _mean(samples.value[near], samples.white), "o", color=color, markersize=3)


def _near(samples: Samples, light: NDArray[np.float64], azimuth_deg: float) -> NDArray[np.bool_]:
    """Tell which samples have that light and a view in the plane, shape (n,)."""
    across = _in_plane(90.0, azimuth_deg + 90.0)
    near = np.linalg.norm(samples.light - light, axis=1) < np.radians(_NEAR_DEG)
    in_plane = np.abs(samples.view @ across) < np.sin(np.radians(_NEAR_DEG))
    return np.asarray(near & in_plane)
