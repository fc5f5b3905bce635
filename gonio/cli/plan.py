"""`gonio plan`: choose what to measure, and in which order."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.core import ParameterSource

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.plan import Plan, Side


@click.command(name="plan")
@click.option(
    "--density",
    type=str.lower,
    metavar="DENSITY",
    default="sixth",
    show_default=True,
    help="How many of the 81 directions on both sides: all (81), sixth (14), or a number; or the "
    "paper's va-ia, vs-ia, va-is, vs-is: views and illumination, all or sixth.",
)
@click.option(
    "--views",
    type=str.lower,
    metavar="DENSITY",
    help="The same for the views alone; goes before --density.",
)
@click.option(
    "--lights",
    type=str.lower,
    metavar="DENSITY",
    help="The same for the lights alone; goes before --density.",
)
@click.option(
    "--criterion",
    type=str.lower,
    metavar="NAME",
    default="i-optimal",
    show_default=True,
    help="How directions are chosen. i-optimal: those that leave the least variance of a material "
    "of the prior, over all pairs. farthest: each as far as can be from those before it.",
)
@click.option(
    "--shots",
    type=int,
    metavar="N",
    help="Choose N pairs freely, rather than all pairs of some views and lights.",
)
@click.option(
    "--prior",
    "prior_path",
    type=click.Path(dir_okay=False, path_type=Path),
    help="What materials look like (see gonio prior).  [default: generated ones]",
)
@click.option(
    "--rig", "rig_path", type=click.Path(path_type=Path), help="A rig file.  [default: built in]"
)
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    default=Path("plan.json"),
    show_default=True,
    help="The plan's file; one that is there is replaced, since a plan is cheap to make again.",
)
@click.option(
    "--plot",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="FILE.png",
    help="Also draw the chosen directions on the hemisphere.",
)
def command(
    *,
    density: str,
    views: str | None,
    lights: str | None,
    criterion: str,
    shots: int | None,
    prior_path: Path | None,
    rig_path: Path | None,
    output: Path,
    plot: Path | None,
) -> None:
    """Choose which directions to measure, and the order that takes the arm the least time.

    \b
    Examples:
        gonio plan                               14 views x 14 lights, 3 % of the full set
        gonio plan --shots 64                    64 pairs, each for what it adds to the others
        gonio plan --density va-is               all views, a sixth of the lights
        gonio plan --views 20 --lights 10 -o small.json
        gonio plan --rig rig.toml --plot directions.png
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.cli._prior import material_prior
    from gonio.errors import BadInputError
    from gonio.rig import default_rig, load_rig
    from nnbrdf.usable import MIN_SAMPLES
    from planner.density import split_density
    from planner.make import make_plan

    context = click.get_current_context()
    given = context.get_parameter_source("density") is not ParameterSource.DEFAULT
    if shots is not None and (views or lights or given):
        raise BadInputError(
            "--shots chooses pairs freely; leave out --density, --views and --lights"
        )
    if prior_path and criterion == "farthest":
        raise BadInputError("criterion farthest knows no prior; leave out --prior")
    prior = material_prior(prior_path) if prior_path else None
    if plot and plot.resolve() == output.resolve():
        raise BadInputError(f"--plot {plot} is where the plan goes; give the picture another name")
    both_views, both_lights = split_density(density)
    plan = make_plan(
        load_rig(rig_path) if rig_path else default_rig(),
        views=views or both_views,
        lights=lights or both_lights,
        criterion=criterion,
        shots=shots,
        prior=lambda: prior or material_prior(None),
    )
    plan.save(output)
    _print_table(plan)
    click.echo(f"wrote {output}, sha256 {plan.sha256}")
    if len(plan.shots) < MIN_SAMPLES:
        click.echo(f"note: gonio reconstruct needs at least {MIN_SAMPLES} shots")
    if plot:
        _draw(plan, plot)
        click.echo(f"wrote {plot}")


def _print_table(plan: Plan) -> None:
    from rich.table import Table

    from gonio.cli._console import console

    table = Table(show_header=False, box=None)
    for name, value in _rows(plan):
        table.add_row(name, value)
    console.print(table)


def _rows(plan: Plan) -> Iterator[tuple[str, str]]:
    from gonio.cli._console import duration, size

    selection, estimates, shots = plan.selection, plan.estimates, len(plan.shots)
    yield "views", str(selection.views)
    yield "lights", str(selection.lights)
    yield "shots", f"{shots}, {shots / selection.full_set:.1%} of the full set"
    yield "measured both ways", f"{selection.reciprocal_pairs} pairs, by reciprocity"
    if selection.variance_left is not None:
        yield "left unknown", f"{selection.variance_left:.2%} of the prior's variance"
    for left_out in plan.left_out:
        yield "left out", f"{left_out.shots} {left_out.reason}"
    yield "estimated time", duration(estimates.total_s)
    for name in ("moving", "settling", "exposing", "overhead"):
        yield f"  {name}", duration(getattr(estimates, f"{name}_s"))
    yield "estimated storage", f"{size(estimates.storage_bytes)} in {estimates.frames} frames"
    yield "route", selection.route
    if plan.route is not None:
        yield "", f"{plan.route.moving_s:.1f} s of moves; {plan.route.bound_s:.1f} s at the least"


def _draw(plan: Plan, path: Path) -> None:
    from gonio.directions import from_degrees, paper_directions
    from gonio.report.hemisphere import save_hemispheres

    candidates = paper_directions()
    chosen = {}
    sides: tuple[Side, ...] = ("view", "light")
    for name in sides:
        angles = sorted({shot.direction_deg(name) for shot in plan.shots})
        theta_deg, phi_deg = zip(*angles, strict=True)
        chosen[f"{name}s: {len(angles)} of {len(candidates)}"] = from_degrees(theta_deg, phi_deg)
    save_hemispheres(path, chosen, candidates)
