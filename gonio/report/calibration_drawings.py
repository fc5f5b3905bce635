"""The pictures of a calibration: photon transfer, linearity, dark level, lamps, maps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.report.figures import ACCENT, CHANNELS, LINE, MUTED, label_decades, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gonio.calibration import CalibrationDocument

_WIDE_IN, _HIGH_IN = 4.2, 2.8
# of a large sensor so many pixels are enough for a picture
_MOST_PIXELS = 400
_MOST_CIRCLES = 500


def draw_transfer(document: CalibrationDocument) -> Figure:
    """Draw variance against signal, and the line that was fitted, both in raw units."""
    figure, axes = _axes("signal (raw units)", "variance (raw units squared)")
    free = [point for point in document.transfer if not point.saturated and point.signal > 0]
    signal = np.array([point.signal for point in free])
    axes.plot(signal, [point.variance for point in free], "o", color=ACCENT, markersize=4)
    read = (document.gain * document.read_noise_e) ** 2
    along = np.geomspace(signal.min(), signal.max(), 50)
    axes.plot(along, document.gain * along + read, color=MUTED, linewidth=1.0, zorder=0)
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        label_decades(axis)
    return figure


def draw_linearity(document: CalibrationDocument) -> Figure:
    """Draw how far signals are from a line, in percent, without and with the correction."""
    figure, axes = _axes("signal (share of the range)", "off the corrected line (%)")
    free = [point for point in document.transfer if not point.saturated]
    dose, signal = (np.array([getattr(p, name) for p in free]) for name in ("dose", "signal"))
    u, corrected = signal / document.linearity.raw_range, document.linearity.undo(signal)
    axes.axhline(0.0, color=LINE, linewidth=1.0)
    for values, face in ((signal, "none"), (corrected, ACCENT)):
        off = 100 * (values / dose - 1.0)
        axes.plot(u, off, "o", color=ACCENT, markerfacecolor=face, markersize=4)
    return figure


def draw_dark(document: CalibrationDocument) -> Figure:
    """Draw the dark level a second of exposure against the time since the first frame."""
    figure, axes = _axes("since the first frame (s)", "dark current (e/s)")
    longest = max(series.exposure_s for series in document.dark)
    long = [series for series in document.dark if series.exposure_s == longest]
    base = min(document.dark, key=lambda series: series.exposure_s).level
    rates = [(series.level - base) / longest / document.gain for series in long]
    axes.plot([series.since_start_s for series in long], rates, "o-", color=ACCENT, markersize=4)
    axes.set_ylim(min(0.0, *rates), 1.2 * max(*rates, 1e-3))
    return figure


def draw_lamps(document: CalibrationDocument) -> Figure:
    """Draw how far the lamps are off their mean, with bars of two sigma."""
    figure, axes = _axes("lamp", "off the mean (%)")
    numbers = [lamp.n for lamp in document.lamps]
    off = [100.0 * (lamp.strength - 1.0) for lamp in document.lamps]
    sigma = [200.0 * lamp.sigma for lamp in document.lamps]
    axes.axhline(0.0, color=LINE, linewidth=1.0)
    axes.errorbar(numbers, off, sigma, fmt="o", color=ACCENT, markersize=4, linewidth=1.0)
    axes.set_xticks(numbers)
    return figure


def draw_field(
    values: NDArray[np.float32], label: str, marked: NDArray[np.bool_] | None = None
) -> Figure:
    """Draw a value of each pixel, shape (height, width), the outermost percent cut off."""
    figure = new_figure(_WIDE_IN, _WIDE_IN + 0.5)
    axes = figure.subplots()
    step = max(1, max(values.shape) // _MOST_PIXELS)
    low, high = np.percentile(values, (0.5, 99.5))
    shown = values[::step, ::step]
    edges = (-0.5, values.shape[1] - 0.5, values.shape[0] - 0.5, -0.5)
    image = axes.imshow(
        shown, interpolation="none", cmap="viridis", vmin=low, vmax=max(high, low + 1e-9),
        extent=edges,
    )  # fmt: skip
    if marked is not None:
        rows, columns = np.nonzero(marked)
        axes.scatter(
            columns[:_MOST_CIRCLES], rows[:_MOST_CIRCLES], s=24, facecolors="none",
            edgecolors=CHANNELS[0], linewidths=0.8,
        )  # fmt: skip
    bar = figure.colorbar(image, ax=axes, orientation="horizontal", aspect=40)
    bar.set_label(label)
    bar.outline.set_visible(False)
    axes.set_axis_off()
    return figure


def _axes(across: str, up: str) -> tuple[Figure, Axes]:
    figure = new_figure(_WIDE_IN, _HIGH_IN)
    axes: Axes = figure.subplots()
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    axes.grid(linewidth=0.6)
    return figure, axes
