"""Figures for the page: sheets in one style, and SVG that takes the page's colors and font."""

from __future__ import annotations

import io
import math
import re
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from markupsafe import Markup, escape

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

INK, MUTED, LINE = "#1b1f24", "#66707a", "#d5dae0"
ACCENT, TRUTH = "#2f6fb5", "#c2571a"
CHANNELS = ("#c8412f", "#2f8f4e", "#2f6fb6")
SERIES = tuple(zip((ACCENT, TRUTH, CHANNELS[1], CHANNELS[0], INK, MUTED), "osD^vP", strict=True))
"""Colors and marks that tell lines or points apart, in their order."""

# what stands in the SVG, and the page's own name for it; light and dark mode give them values
_VARIABLES = {
    INK: "ink", MUTED: "muted", LINE: "line", ACCENT: "accent", TRUTH: "truth",
    **dict(zip(CHANNELS, ("red", "green", "blue"), strict=True)),
    # of the hemisphere, which the plan draws on white paper too
    "#666666": "muted", "#999999": "muted", "#e6e6e6": "line", "#1f77b4": "accent",
}  # fmt: skip

_MANY = 300.0
_LEAST_TICKS = 3
_DIGITS = ((1,), (1, 2, 5), (1, 1.5, 2, 3, 5, 7))

_STYLE: dict[Any, Any] = {
    "svg.fonttype": "none", "svg.hashsalt": "gonio", "svg.image_inline": True, "font.size": 8.5,
    "text.color": INK, "axes.labelcolor": MUTED, "axes.edgecolor": MUTED,
    "xtick.color": MUTED, "ytick.color": MUTED, "grid.color": LINE, "axes.facecolor": "none",
    "figure.facecolor": "none", "axes.spines.top": False, "axes.spines.right": False,
    "legend.frameon": False, "lines.linewidth": 1.4,
}  # fmt: skip


@contextmanager
def page_style() -> Iterator[None]:
    """Draw and save figures in the page's style while this is open."""
    from matplotlib import rc_context

    with rc_context(_STYLE):
        yield


def new_figure(width_in: float, height_in: float) -> Figure:
    """Return an empty figure that lays itself out."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width_in, height_in), dpi=200, layout="constrained")


def literal(name: str) -> str:
    """Return what draws a name as it is: what stands between dollars would be set as formulas."""
    return name.replace("$", r"\$")


def label_decades(axis: Axis) -> None:
    """Label a logarithmic axis with plain numbers, three of them or more, as round as can be."""
    from matplotlib.ticker import FixedLocator, NullLocator, StrMethodFormatter

    axis.set_major_locator(FixedLocator(round_numbers(*axis.get_view_interval())))
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_locator(NullLocator())


def round_numbers(low: float, high: float) -> list[float]:
    """Return at least three numbers between two positive ones, the roundest first tried.

    Of many decades powers of ten alone; of few 1, 2 and 5; of less than one, even steps.
    """
    from matplotlib.ticker import MaxNLocator

    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for digits in _DIGITS[1 if high < _MANY * low else 0 :]:
        ticks = [float(f"{digit}e{decade}") for decade in decades for digit in digits]
        ticks = [tick for tick in ticks if low <= tick <= high]
        if len(ticks) >= _LEAST_TICKS:
            return ticks
    even = MaxNLocator(2 * _LEAST_TICKS).tick_values(low, high)
    return [float(tick) for tick in even if low <= tick <= high]


def inline_svg(figure: Figure, name: str, label: str) -> Markup:
    """Return a figure as an SVG element.

    Parameters
    ----------
    figure
        Drawn within `page_style`.
    name
        Of the figure on its page: keeps its ids apart from those of others.
    label
        What a screen reader says.
    """
    text = _svg(figure)
    text = re.sub(r'<svg [^>]*(viewBox="[^"]*")[^>]*>', r"<svg \1 @@@>", text, count=1)
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r'(href="|url\()#', rf"\1#{name}-", text)
    text = re.sub(r"(font:[^;\"]*?)'[^;\"]*", r"\1var(--sans)", text)
    for color, variable in _VARIABLES.items():
        text = text.replace(color, f"var(--{variable})")
    return Markup(text.replace("@@@", f'role="img" aria-label="{escape(label)}"'))


def _svg(figure: Figure) -> str:
    buffer = io.StringIO()
    # without dates and makers: the same model gives the same figure
    nothing: dict[str, Any] = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    figure.savefig(buffer, format="svg", metadata=nothing)
    text = buffer.getvalue()
    return text[text.index("<svg ") :]
