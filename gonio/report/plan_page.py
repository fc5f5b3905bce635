"""The page of a plan: what will be measured, in which order, how long, and why."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.files import write_bytes
from gonio.report import plan_drawings as draw
from gonio.report.drawings import Drawing
from gonio.report.figures import inline_svg, page_style
from gonio.report.planned import Planned
from gonio.words import duration, size

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gonio.plan import Estimates, Plan
    from gonio.report.planned import Side
    from gonio.rig import Rig
    from planner.candidates import Candidates

_SELECTION = {
    "criterion": "criterion",
    "candidates": "candidates",
    "full_set": "pairs of candidates",
    "reciprocal_pairs": "measured both ways round",
    "route": "route",
}
_SEEN = "seen against the sample's normal; φ counts counter-clockwise from the marked edge"


def write_plan_page(
    target: Path,
    plan: Plan,
    rig: Rig,
    lights: Candidates,
    views: Candidates,
    refused: Mapping[str, NDArray[np.bool_]] | None = None,
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
        Which pairs the rig cannot take, by reason, shape (lights, views) each.

    Raises
    ------
    gonio.errors.StorageError
        When it cannot be written.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    planned = Planned.of(plan, rig, lights, views, refused or {})
    with page_style():
        drawn = {
            "directions": list(_directions(planned)),
            "route": list(_route(planned)),
            "progress": _drawing("Shots against time", draw.draw_progress(planned, _ends_s(plan.estimates)), _before(planned)),
            "pairs": _drawing("Pairs", draw.draw_pairs(planned), "Each row is a light, each column a view."),
        }
    environment = Environment(
        loader=PackageLoader("gonio", "report"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    page = environment.get_template("plan.html").render(
        plan=plan, drawn=drawn, parts=list(_parts(plan.estimates)), facts=list(_facts(plan)),
        ...
    )
    write_bytes(target, page.encode("utf-8", "backslashreplace"))
