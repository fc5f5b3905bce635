"""The stability study's tables and pictures."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from gonio.report.drawings import Drawing
from gonio.report.figures import ACCENT, MUTED, inline_svg, label_decades, new_figure, page_style
from gonio.report.grids import Grid, Line

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nnbrdf.stability.precision import Drift
    from nnbrdf.stability.starts import Start

_SHADES = (ACCENT, MUTED)


def cases_grid(outcomes: Mapping[str, Mapping[str, str]]) -> Grid:
    """Return what happened in each case, alike activations counted together."""
    lines = []
    for case, by_activation in outcomes.items():
        counts = Counter(by_activation.values())
        said = "; ".join(f"{count} of 20: {what}" for what, count in counts.most_common())
        lines.append(Line((case, said), best=False))
    title, head = "Extreme samples, all twenty activations", ("case", "what happens")
    return Grid(title, head, tuple(lines), words=True)


def starts_grid(starts: Mapping[str, Start]) -> Grid:
    """Return how each activation begins and ends."""
    head = (
        "",
        "first output",
        "first gradient",
        "largest of 20",
        "no better than a constant",
        "diverged",
        "dead units",
    )
    lines = tuple(
        Line(
            (
                name, f"{start.output:.3g}", f"{start.gradient:.3g}",
                f"{start.largest_gradient:.3g}", f"{start.idle} of 20",
                f"{start.diverged} of 20", f"{100 * start.dead:.0f} %",
            ),
            best=False,
        )
        for name, start in starts.items()
    )  # fmt: skip
    return Grid("How a training begins and ends: twenty seeds", head, lines)


def limits_grid(rows: Sequence[tuple[str, float, float, float]]) -> Grid:
    """Return factors of growth about the limits: method, share of the limit, rate, growth."""
    lines = tuple(
        Line((method, f"{share:.2f}", f"{rate:.4g}", f"{growth:.2g}"), best=False)
        for method, share, rate, growth in rows
    )
    head = ("method", "share of the limit", "step size", "error after 400 steps, over the first")
    return Grid("Squared loss: steps at and past the limit", head, lines)


def draw_drift(drifts: Mapping[str, Drift]) -> Drawing:
    """Draw how single and double precision part."""
    with page_style():
        figure = new_figure(4.6, 3.2)
        axes = figure.subplots()
        for (name, drift), color in zip(drifts.items(), _SHADES, strict=False):
            axes.plot(drift.steps, drift.apart, color=color, label=name)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("step")
        axes.set_ylabel("mean difference (units of white)")
        axes.grid(linewidth=0.5)
        axes.legend(fontsize=8)
        title = "Single against double precision"
        caption = "; ".join(
            f"{name}: final loss {drift.losses[0].mean():.4f} in single, "
            f"{drift.losses[1].mean():.4f} in double, standard error {_error(drift):.4f}"
            for name, drift in drifts.items()
        )
        return Drawing(title, inline_svg(figure, "drift", title), f"Median of 20 seeds; {caption}.")


def draw_floor(rates: Sequence[float], floors: Mapping[int, Sequence[float]]) -> Drawing:
    """Draw the final absolute loss against the step size."""
    with page_style():
        figure = new_figure(4.6, 3.2)
        axes = figure.subplots()
        for (steps, losses), color in zip(floors.items(), _SHADES, strict=False):
            axes.plot(rates, losses, "o-", color=color, markersize=3, label=f"{steps} steps")
        axes.set_xscale("log")
        axes.set_yscale("log")
        label_decades(axes.yaxis)
        axes.set_xlabel("step size of Adamax")
        axes.set_ylabel("final loss (units of white)")
        axes.grid(linewidth=0.5)
        axes.legend(fontsize=8)
        title = "Absolute loss: where it comes to rest"
        caption = (
            "The gradient of an absolute value does not shrink towards a minimum, so no step is "
            "small enough to settle and none large enough to explode: the step sets the floor."
        )
        return Drawing(title, inline_svg(figure, "floor", title), caption)


def _error(drift: Drift) -> float:
    return float(drift.losses.std(axis=1, ddof=1).mean() / drift.losses.shape[1] ** 0.5)
