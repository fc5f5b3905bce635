"""A figure with its title and caption, and those that show how good a model is."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from gonio.report import errors
from gonio.report.figures import inline_svg

if TYPE_CHECKING:
    from collections.abc import Iterator

    from markupsafe import Markup
    from matplotlib.figure import Figure

    from gonio.report.sources import Sources

_ENDS_AT_WHITE = {"paper": " Beyond it, the network was told no more than white."}


class Drawing(NamedTuple):
    """A figure with its title and its caption."""

    title: str
    svg: Markup
    caption: str


def drawing(title: str, figure: Figure, caption: str) -> Drawing:
    """Return a figure, drawn within `gonio.report.figures.page_style`, as a part of the page."""
    name = "-".join(title.lower().split())
    return Drawing(title, inline_svg(figure, name, f"{title}: {caption}"), caption)


def error_drawings(sources: Sources) -> Iterator[Drawing]:
    """Draw how the model meets its samples, and how it was trained where that is known.

    `gonio.report.figures.page_style` has to be open.
    """
    from nnbrdf.history import FILE_NAME, History

    estimate, history = sources.estimate, sources.model / FILE_NAME
    yield drawing(
        "Model against samples",
        errors.draw_scatter(estimate, sources.samples),
        f"A dot a value; upright line: white.{_ENDS_AT_WHITE.get(estimate.card.estimator, '')}",
    )
    if history.is_file():
        what = "Loss" if sources.truth is None else "Error"
        yield drawing(
            f"{what} against training time",
            errors.draw_training(History.load(sources.model), sources.truth),
            "Thin: each network; thick: their median.",
        )
