"""What `gonio plan` draws."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.plan import Plan, Side
    from gonio.rig import Rig
    from planner.candidates import Candidates
    from planner.scene.pairs import LocalPairs


def write_page(
    path: Path,
    plan: Plan,
    rig: Rig,
    sides: tuple[Candidates, Candidates],
    max_theta_deg: float | None,
    asked: LocalPairs | None,
) -> None:
    """Write the plan's page.

    Parameters
    ----------
    sides
        Candidates for views and for lights.
    max_theta_deg
        The grazing limit that the plan was made with.
    asked
        What the scene asks for, where the plan was made for one.
    """
    from gonio.report.plan_page import write_plan_page
    from planner.reach import reach_of

    views, lights = sides
    refused = reach_of(lights, views, rig, max_theta_deg).reasons
    write_plan_page(path, plan, rig, lights, views, refused, asked)


def draw_plan(plan: Plan, path: Path, views: Candidates, lights: Candidates) -> None:
    """Draw the chosen directions on the hemisphere, views and lights side by side."""
    from gonio.directions import from_degrees
    from gonio.report.hemisphere import save_hemispheres

    chosen = {}
    sides: tuple[tuple[Side, Candidates], ...] = (("view", views), ("light", lights))
    for name, candidates in sides:
        angles = sorted({shot.direction_deg(name) for shot in plan.shots})
        theta_deg, phi_deg = zip(*angles, strict=True)
        title = f"{name}s: {len(angles)} of {len(candidates)}"
        chosen[title] = from_degrees(theta_deg, phi_deg), candidates.directions
    save_hemispheres(path, chosen)


def draw_demand(pairs: LocalPairs, path: Path) -> None:
    """Draw what a scene asks for."""
    from gonio.report.demand import save_demand

    save_demand(path, pairs.light, pairs.view, pairs.weight)
