"""The pictures of a plan: directions, route, progress, pairs."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gonio.report.figures import ACCENT, CHANNELS, LINE, MUTED, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gonio.report.planned import Directions, Planned

    Array = NDArray[np.float64]

TIME_COLORS = ("#3d7bd9", "#8a63d2", "#d14f93", "#ee7b3a")
"""Of the first shot to the last: all of a lightness that is seen on white and on black."""
NOT_CHOSEN = "#80808029"

_SIDE_IN = 3.4
_PARTS = 48
_RINGS_DEG = (30.0, 60.0, 90.0)
# between the candidates of rings
_LABEL_OUT_DEG, _LABEL_PHI_DEG = 6.5, 10.0
_SPREAD = 0.2
_MAP_SIDE = 120
# beyond it candidates are dots, which are small on the page and in the file
_MANY = 300
_REFUSED = ("#c8412f90", "#d99a2b90", "#7a6a9e90", "#4d8f8a90")


def refused_color(number: int) -> str:
    """Return the color of a reason why the rig cannot take a pair, by its number."""
    return _REFUSED[number % len(_REFUSED)]


def draw_directions(side: Directions) -> Figure:
    """Draw which candidates of a side are chosen, the larger the more shots, skipped or refused."""
    figure, axes = _disc()
    x, y = _flat(side.theta_deg, side.phi_deg)
    chosen = side.times > 0
    skipped = ~chosen & ~side.refused
    # areas: many candidates leave less room to each
    room = min(1.0, (81 / len(side)) ** 0.6)
    if len(side) > _MANY:
        _dots(axes, x[skipped], y[skipped], LINE, 1.5)
        _dots(axes, x[side.refused], y[side.refused], CHANNELS[0], 1.5)
    else:
        axes.scatter(
            x[skipped], y[skipped], s=16 * room, facecolors="none", edgecolors=MUTED, linewidths=0.7
        )
        axes.scatter(
            x[side.refused], y[side.refused], s=18 * room, marker="x", color=CHANNELS[0],
            linewidths=0.9,
        )  # fmt: skip
    share = side.times[chosen] / side.times.max()
    axes.scatter(x[chosen], y[chosen], s=room * (14 + 40 * share), color=ACCENT, linewidths=0)
    return figure


def draw_route(side: Directions) -> Figure:
    """Draw the shots of a side as one line in their order, colored by time.

    Shots of one direction lie around it on a small circle, clockwise from the top as time passes,
    so that lines which go there and back again stay apart.
    """
    figure, axes = _disc()
    _dots(axes, *_flat(side.theta_deg, side.phi_deg), LINE, 1.8)
    x, y = _flat(side.theta_deg[side.of_shot], side.phi_deg[side.of_shot])
    turn = 2.0 * np.pi * np.arange(len(x)) / max(len(x), 1)
    away = _SPREAD * _spacing_deg(side)
    x, y = x + away * np.sin(turn), y + away * np.cos(turn)
    _line_in_time(axes, x, y, linewidth=0.8 if len(x) <= 1000 else 0.4)
    for place, mark, color in ((0, "o", TIME_COLORS[0]), (-1, "s", TIME_COLORS[-1])):
        axes.plot(
            x[place], y[place], mark, color=color, markersize=6, markeredgecolor=ACCENT,
            markeredgewidth=1.2, zorder=4,
        )  # fmt: skip
    return figure


def draw_progress(planned: Planned, ends_s: tuple[float, float] | None) -> Figure:
    """Draw how many shots are done after which time, and between which times the last may be."""
    figure = new_figure(4.2, 2.4)
    axes = figure.subplots()
    unit_s, unit = (3600.0, "h") if planned.done_s[-1] > 2 * 3600 else (60.0, "min")
    shots = len(planned.done_s)
    done = np.concatenate([[0.0, planned.done_s[0]], planned.done_s]) / unit_s
    count = np.concatenate([[0, 0], np.arange(1, shots + 1)])
    _line_in_time(axes, done, count.astype(float), linewidth=2.0)
    axes.plot(done[-1], shots, "s", color=TIME_COLORS[-1], markersize=5, zorder=4)
    if ends_s:
        low, high = (end / unit_s for end in ends_s)
        axes.plot([low, high], [shots, shots], "|-", color=MUTED, linewidth=1.2, markersize=8)
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
    axes.grid(linewidth=0.5)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.locator_params("y", integer=True)
    axes.set_xlabel(f"time since the start ({unit})")
    axes.set_ylabel("shots done")
    return figure


def draw_pairs(planned: Planned) -> Figure:
    """Draw all pairs of candidates: taken, in the colors of time; not chosen; refused by reason."""
    figure = new_figure(4.6, 4.6)
    axes = figure.subplots()
    axes.imshow(_pair_colors(planned), interpolation="none", aspect="auto")
    for axis, side, name in (
        (axes.xaxis, planned.view, "view"),
        (axes.yaxis, planned.light, "light"),
    ):
        ticks = _theta_ticks(side.theta_deg)
        axis.set_ticks([place - 0.5 for place in ticks], [f"{ticks[p]:g}°" for p in ticks])
        axis.set_tick_params(labelsize=7)
        axis.set_label_text(f"{name} candidate" + (", from this θ on" if ticks else ""))
    axes.spines[:].set_visible(False)
    return figure


def _pair_colors(planned: Planned) -> Array:
    """Return red, green, blue and alpha of each pair, shape (lights, views, 4)."""
    from matplotlib.colors import to_rgba

    picture = np.full((len(planned.light), len(planned.view), 4), to_rgba(NOT_CHOSEN))
    for number, pairs in enumerate(planned.refused.values()):
        picture[pairs] = to_rgba(refused_color(number))
    colors = _time_map()(np.linspace(0.0, 1.0, len(planned.done_s)))
    # of many candidates a single pair would be too small to see
    wide = -(-max(picture.shape[:2]) // _MAP_SIDE) - 1
    for down in range(-(wide // 2), wide - wide // 2 + 1):
        for right in range(-(wide // 2), wide - wide // 2 + 1):
            row = (planned.light.of_shot + down).clip(0, len(planned.light) - 1)
            column = (planned.view.of_shot + right).clip(0, len(planned.view) - 1)
            picture[row, column] = colors
    return picture


def _theta_ticks(theta_deg: Array) -> dict[int, float]:
    """Return at which candidate theta reaches each multiple of 15 deg; none where mixed."""
    if (np.diff(theta_deg) < 0).any():
        return {}
    marks = np.arange(0.0, 90.0, 15.0)
    places = np.searchsorted(theta_deg, marks - 1e-9)
    ticks: dict[int, float] = {}
    for place, theta in zip(places.tolist(), marks.tolist(), strict=True):
        # two labels need some room
        if (
            place < len(theta_deg)
            and place >= max(ticks, default=-len(theta_deg)) + len(theta_deg) / 25
        ):
            ticks[place] = theta
    return ticks


def _disc() -> tuple[Figure, Axes]:
    """Return the hemisphere seen against the sample's normal; the radius is theta in degrees."""
    figure = new_figure(_SIDE_IN, _SIDE_IN)
    # laying itself out would take longer than all the rest
    figure.set_layout_engine("none")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    around = np.linspace(0.0, 2.0 * np.pi, 121)
    for ring in _RINGS_DEG:
        axes.plot(ring * np.cos(around), ring * np.sin(around), color=LINE, linewidth=0.8, zorder=0)
        (x,), (y,) = _flat(np.array([ring + _LABEL_OUT_DEG]), np.array([_LABEL_PHI_DEG]))
        axes.annotate(f"{ring:g}°", (x, y), color=MUTED, fontsize=6, ha="center", va="center")
    for phi in (0.0, 45.0, 90.0, 135.0):
        x, y = _flat(np.array([90.0, -90.0]), np.array([phi, phi]))
        axes.plot(x, y, color=LINE, linewidth=0.5, zorder=0)
    axes.annotate("φ 0°", (92.0, 0.0), color=MUTED, fontsize=6, va="center")
    axes.set_xlim(-96.0, 108.0)
    axes.set_ylim(-102.0, 102.0)
    axes.set_aspect("equal")
    axes.set_axis_off()
    return figure, axes


def _dots(axes: Axes, x: Array, y: Array, color: str, width_pt: float) -> None:
    """Draw dots as one line of strokes too short to see: a mark each would take ten times that."""
    gap = np.full_like(x, np.nan)
    along = np.stack([x, x + 0.01, gap], axis=1).ravel(), np.stack([y, y, gap], axis=1).ravel()
    axes.plot(*along, color=color, linewidth=width_pt, solid_capstyle="round", zorder=1)


def _flat(theta_deg: Array, phi_deg: Array) -> tuple[Array, Array]:
    phi = np.radians(phi_deg)
    return theta_deg * np.cos(phi), theta_deg * np.sin(phi)


def _spacing_deg(side: Directions) -> float:
    """Return about how far a candidate is from the next, were they spread evenly."""
    return float(min(15.0, 150.0 / np.sqrt(len(side))))


def _line_in_time(axes: Axes, x: Array, y: Array, linewidth: float) -> None:
    """Draw a line whose color passes from the first shot's to the last's, in a few pieces."""
    ends = np.unique(np.linspace(0, len(x) - 1, _PARTS + 1).round().astype(int))
    colors = _time_map()(np.linspace(0.0, 1.0, max(len(ends) - 1, 1)))
    for (start, end), color in zip(pairwise(ends.tolist()), colors, strict=False):
        axes.plot(x[start : end + 1], y[start : end + 1], color=color, linewidth=linewidth)


def _time_map() -> Colormap:
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("time", TIME_COLORS)
