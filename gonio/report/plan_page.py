"""The page of a plan: what will be measured, in which order, how long, and why."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.files import write_bytes
from gonio.report import plan_drawings as draw
from gonio.report.demand import draw_demand
from gonio.report.drawings import Drawing
from gonio.report.figures import inline_svg, page_style
from gonio.report.plan_facts import cards, ends_s, facts, parts, spared_rows
from gonio.report.planned import Planned
from gonio.words import duration, several

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gonio.plan import Plan
    from gonio.report.planned import Directions
    from gonio.rig import Rig
    from planner.candidates import Candidates
    from planner.scene.pairs import LocalPairs

_SEEN = "Against the sample's normal; φ counts counter-clockwise from the marked edge."


def write_plan_page(
    target: Path,
    plan: Plan,
    rig: Rig,
    lights: Candidates,
    views: Candidates,
    refused: Mapping[str, NDArray[np.bool_]] | None = None,
    asked: LocalPairs | None = None,
) -> None:
    """Write the page of a plan, self-contained; the same plan gives the same bytes.

    Parameters
    ----------
    target
        The page.
    plan
        Whose shots are among the candidates.
    rig
        What it was made for.
    lights, views
        The directions that it chose from.
    refused
        Which pairs the rig cannot take, by reason as the plan states it, shape (lights, views)
        each.
    asked
        What the scene asks for, where the plan was made for one.

    Raises
    ------
    gonio.errors.StorageError
        When it cannot be written.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    refused = refused or {}
    planned = Planned.of(plan, rig, lights, views, refused)
    environment = Environment(
        loader=PackageLoader("gonio", "report"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    of_time = list(parts(plan.estimates))
    page = environment.get_template("plan.html").render(
        title=f"{several(len(plan.shots), 'shot')} in {duration(plan.estimates.total_s)}",
        plan=plan,
        cards=list(cards(plan)),
        parts=of_time,
        longest=max(seconds for _, seconds, _ in of_time) or 1.0,
        drawn=_drawn(plan, planned, asked),
        colors=draw.TIME_COLORS,
        left_out=list(_left_out(plan, refused)),
        facts=list(facts(plan)),
    )
    write_bytes(target, page.encode("utf-8", "backslashreplace"))


def _drawn(
    plan: Plan, planned: Planned, asked: LocalPairs | None
) -> dict[str, Drawing | list[Drawing]]:
    sides = {"Lights": planned.light, "Views": planned.view}
    with page_style():
        return {
            "directions": [
                _drawing(name, draw.draw_directions(side), _counts(side))
                for name, side in sides.items()
            ],
            "route": [
                _drawing(f"Route of the {name.lower()}", draw.draw_route(side), _SEEN)
                for name, side in sides.items()
            ],
            "progress": _drawing(
                "Shots against time",
                draw.draw_progress(planned, ends_s(plan.estimates)),
                _first(planned),
            ),
            "pairs": _drawing(
                "Lights by views",
                draw.draw_pairs(planned),
                "A row a light, a column a view, in the order of the candidates.",
            ),
            "demand": [] if asked is None else [_demand(asked)],
        }


def _drawing(title: str, figure: Figure, caption: str) -> Drawing:
    name = "-".join(title.lower().split())
    return Drawing(title, inline_svg(figure, name, f"{title}: {caption}"), caption)


def _demand(asked: LocalPairs) -> Drawing:
    figure = draw_demand(asked.light, asked.view, asked.weight)
    return _drawing(
        "Demand of the scene", figure, f"{several(len(asked.weight), 'sample')}. {_SEEN}"
    )


def _counts(side: Directions) -> str:
    chosen = side.times > 0
    refused = int((side.refused & ~chosen).sum())
    skipped = len(side) - refused - int(chosen.sum())
    cannot = f", {refused} out of reach" if refused else ""
    return f"{chosen.sum()} chosen of {len(side)}, {skipped} skipped{cannot}. {_SEEN}"


def _first(planned: Planned) -> str:
    return (
        f"The first shot is done after {duration(float(planned.done_s[0]))}: homing, dark and "
        "white frames come before it."
    )


def _left_out(
    plan: Plan, refused: Mapping[str, NDArray[np.bool_]]
) -> Iterator[tuple[str, str, str, list[str]]]:
    """Yield why pairs are left out, how many, their color on the map, and what that spares."""
    colors = {reason: draw.refused_color(number) for number, reason in enumerate(refused)}
    for left in plan.left_out:
        spared = [" ".join(row) for row in spared_rows(left)]
        yield left.reason, str(left.shots), colors.get(left.reason, draw.NOT_CHOSEN), spared
    counted = {left.reason for left in plan.left_out}
    for reason, pairs in refused.items():
        if reason not in counted and pairs.any():
            yield f"{reason}: never chosen", f"({pairs.sum()})", colors[reason], []
