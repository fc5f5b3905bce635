"""What settings of a training do to a ranking, as parts of a study's page."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING

from gonio.report.drawings import Drawing
from gonio.report.figures import inline_svg, page_style
from gonio.report.grids import DIGITS, NAMES, Grid, Line, Section, identifier, number
from gonio.report.pareto import Point, draw_pareto
from nnbrdf.studies.tables import means_of, ranking

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nnbrdf.studies.settings import Ranked
    from nnbrdf.studies.tables import Table


def settings_section(material: str, settings: Mapping[str, Ranked]) -> Section:
    """Return one material: means side by side, how the orders agree, and error against time.

    Parameters
    ----------
    settings
        By name, of the same rows and metric; the first is what the others are held against.
    """
    drawing = _pareto(material, settings)
    drawings = () if drawing is None else (drawing,)
    return Section(material, drawings, (_side_by_side(settings), _orders(settings)))


def _side_by_side(settings: Mapping[str, Ranked]) -> Grid:
    metric = next(iter(settings.values())).errors.metric
    rows = means_of([each.errors for each in settings.values()])
    lines = tuple(
        Line((name, *(number(mean, DIGITS[metric]) for mean in means)), best=index == 0)
        for index, (name, *means) in enumerate(rows)
    )
    return Grid(f"{NAMES[metric]}: mean of the subsets", ("", *settings), lines)


def _orders(settings: Mapping[str, Ranked]) -> Grid:
    recipe = next(iter(settings.values()))
    head = (
        "setting", "Kendall's tau to the recipe", "between its own seeds",
        "best", "second", "third", "rank of softsign",
    )  # fmt: skip
    lines = tuple(_order_line(name, recipe, ranked) for name, ranked in settings.items())
    return Grid("What it does to the ranking", head, lines)


def _order_line(name: str, recipe: Ranked, ranked: Ranked) -> Line:
    ranks = {row.name: row.rank for row in ranked.errors.rows}
    first, second, third = [*ranking(ranked.errors), "", ""][:3]
    taus = (ranked.tau_to(recipe), ranked.tau_between_seeds)
    agreements = ("" if each is None else f"{each:.2f}" for each in taus)
    cells = (name, *agreements, first, second, third, str(ranks.get("softsign", "")))
    return Line(cells, best=False)


def _pareto(material: str, settings: Mapping[str, Ranked]) -> Drawing | None:
    points = [
        Point(name, seconds, error)
        for name, ranked in settings.items()
        if (seconds := _middle(ranked.times)) is not None
        and (error := _middle(ranked.errors)) is not None
    ]
    if not points:
        return None
    error_name = f"{NAMES['eps8']}, median of the rows"
    title = "eps8 against training time"
    with page_style():
        figure = draw_pareto(points, error_name, "training time (s)")
        svg = inline_svg(figure, f"{identifier(material)}-settings", title)
    return Drawing(title, svg, "Each point is a setting. Nobody beats those on the line in both.")


def _middle(table: Table) -> float | None:
    means = [row.mean for row in table.rows if row.mean is not None]
    return median(means) if means else None
