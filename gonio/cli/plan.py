"""`gonio plan`: choose what to measure, and in which order."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from gonio.cli._scene import SceneOptions, scene_options

if TYPE_CHECKING:
    from gonio.plan import Plan, Side
    from gonio.rig import Rig
    from planner.candidates import Candidates

BRACKETS = ("all", "predicted")


@click.command(name="plan")
@click.option(
    "--density",
    type=str.lower,
    metavar="DENSITY",
    default="sixth",
    show_default=True,
    help="How many of the directions on both sides: all (81), sixth (14), or a number; or the "
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
    "of the prior, over all pairs. d-optimal: those that tell most together. Without a prior: "
    "energy (they repel each other), farthest (each as far as can be from those before), random.",
)
@click.option(
    "--weight",
    type=click.Choice(["alike", "cosine"], case_sensitive=False),
    default="alike",
    show_default=True,
    help="How much a pair counts for i-optimal: all alike, or by the cosines of both directions, "
    "as a surface looks smaller when seen or lit at grazing angles.",
)
@click.option(
    "--candidates",
    metavar="SET",
    default="paper-81",
    show_default=True,
    help="The directions to choose from: paper-81, klems (145), rings:0x1,30x8,60x16 (theta x "
    "azimuths), fibonacci:N, or a CSV file with columns theta_deg, phi_deg.",
)
@click.option(
    "--view-candidates", metavar="SET", help="The same for the views alone; before --candidates."
)
@click.option(
    "--light-candidates", metavar="SET", help="The same for the lights alone; before --candidates."
)
@click.option(
    "--max-theta",
    "max_theta_deg",
    type=float,
    metavar="DEG",
    help="Leave out directions of lights and views closer to grazing than that, 0 to 90.",
)
@click.option("--seed", type=click.IntRange(min=0), help="Of the random criterion.  [default: 0]")
@click.option(
    "--shots",
    type=int,
    metavar="N",
    help="Choose N pairs freely, rather than all pairs of some views and lights.",
)
@click.option(
    "--hours",
    type=click.FloatRange(min=0, min_open=True, max=10_000),
    metavar="H",
    help="Choose as many pairs as the rig can take in so many hours, calibration and all, each for "
    "what it tells per second of reaching and taking it.",
)
@click.option(
    "--continue",
    "continued",
    type=click.Path(path_type=Path),
    metavar="SESSION",
    help="Choose the next shots of SESSION by what was measured of its material, and add them to "
    "its plans; --shots says how many.  [default: 16]",
)
@scene_options
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
    "--timing",
    "timing_path",
    type=click.Path(dir_okay=False, path_type=Path),
    help="What the rig takes, from gonio rig bench.  [default: rig-timing.json beside the rig file "
    "or here, if it is of this rig]",
)
@click.option(
    "--bracket",
    type=click.Choice(BRACKETS, case_sensitive=False),
    help="Exposures of a shot. all: every one of the rig file. predicted: the fewest that "
    "show it, however bright a material of the prior may be there.  [default: predicted where "
    "the rig's timing was measured, else all]",
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
@click.option(
    "--pareto",
    is_flag=True,
    help="Make no plan, but many, and say which to take: expected error against time for several "
    "densities and criteria (or the one given), as pareto.html and pareto.csv beside -o.",
)
@click.option(
    "--page/--no-page",
    default=True,
    show_default=True,
    help="Write the plan's page beside it: directions, order, time, what was left out.",
)
def command(
    *,
    density: str,
    views: str | None,
    lights: str | None,
    criterion: str,
    weight: str,
    candidates: str,
    view_candidates: str | None,
    light_candidates: str | None,
    max_theta_deg: float | None,
    seed: int | None,
    shots: int | None,
    hours: float | None,
    continued: Path | None,
    scene: Path | None,
    material: str | None,
    isotropic: bool,
    mono: bool,
    plot_demand: Path | None,
    prior_path: Path | None,
    rig_path: Path | None,
    timing_path: Path | None,
    bracket: str | None,
    output: Path,
    plot: Path | None,
    pareto: bool,
    page: bool,
) -> None:
    """Choose which directions to measure, and the order that takes the arm the least time.

    \b
    Examples:
        gonio plan                               14 views x 14 lights, 3 % of the full set
        gonio plan --shots 64                    64 pairs, each for what it adds to the others
        gonio plan --hours 1.5                   the pairs that tell most in an hour and a half
        gonio plan --density va-is               all views, a sixth of the lights
        gonio plan --views 20 --lights 10 -o small.json
        gonio plan --candidates fibonacci:300 --shots 196
        gonio plan --rig rig.toml --plot directions.png
        gonio plan --bracket predicted           only the exposures that a shot may need
        gonio plan --scene wall.toml             only what the scene asks for
        gonio plan --pareto                      how many shots are worth their time
        gonio plan --continue session/ --shots 20
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from functools import partial

    from gonio.cli._continue import go_on, refuse_others, tell
    from gonio.cli._pareto import write_pareto
    from gonio.cli._plan_table import print_plan
    from gonio.cli._prior import material_prior, with_prior
    from gonio.cli._timing import timing_for
    from gonio.errors import BadInputError
    from gonio.rig import default_rig, load_rig
    from nnbrdf.usable import MIN_SAMPLES
    from planner.candidates import candidates_named
    from planner.density import split_density
    from planner.field import cosine_demand
    from planner.make import field_within, make_plan

    if continued is not None:
        refuse_others(criterion)
        _refuse_idle(criterion, weight, seed, prior_path)
        path, plan = go_on(
            continued,
            shots,
            prior_path,
            timing_path,
            bracket,
            criterion=criterion,
            demand=cosine_demand if weight == "cosine" else None,
            max_theta_deg=max_theta_deg,
            view_candidates=candidates_named(view_candidates or candidates),
            light_candidates=candidates_named(light_candidates or candidates),
        )
        print_plan(plan)
        tell(plan, path)
        return
    context = click.get_current_context()
    given = context.get_parameter_source("density") is not ParameterSource.DEFAULT
    if (shots is not None or hours is not None) and (views or lights or given):
        raise BadInputError(
            "--shots and --hours choose pairs freely; leave out --density, --views and --lights"
        )
    if hours is not None and (shots is not None or scene or isotropic or pareto):
        raise BadInputError(
            "--hours says how much to measure; leave out --shots, --scene, --isotropic and --pareto"
        )
    use = SceneOptions(scene, material, isotropic, mono, plot_demand)
    every = pareto and context.get_parameter_source("criterion") is ParameterSource.DEFAULT
    if pareto and (shots is not None or views or lights or given or plot or use.given):
        raise BadInputError(
            "--pareto tries densities of its own; leave out --density, --views, --lights, --shots, "
            "--scene, --isotropic and --plot"
        )
    rig = load_rig(rig_path) if rig_path else default_rig()
    timing = timing_for(rig, rig_path, timing_path)
    # how bright shots come out hangs on the camera, of which only a measurement tells
    bracket = bracket or ("predicted" if timing else "all")
    if pareto and not every:
        _refuse_idle(criterion, "alike", seed, None)
    if not pareto:
        _refuse_idle(criterion, weight, seed, None if bracket == "predicted" else prior_path)
        use.check(criterion, weight, output)
    prior = material_prior(prior_path) if prior_path else None
    if plot and plot.resolve() == output.resolve():
        raise BadInputError(f"--plot {plot} is where the plan goes; give the picture another name")
    page_path = output.with_suffix(".html")
    if page and page_path in (output, plot):
        raise BadInputError(
            f"{page_path} is where the plan's page goes; take another, or --no-page"
        )
    both_views, both_lights = split_density(density)
    view_set = candidates_named(view_candidates or candidates)
    light_set = candidates_named(light_candidates or candidates)
    believed = cache(lambda: prior or material_prior(None))
    settings: dict[str, Any] = {
        "view_candidates": view_set,
        "light_candidates": light_set,
        "demand": cosine_demand if weight == "cosine" else None,
        "max_theta_deg": max_theta_deg,
        "seed": seed or 0,
        "timing": timing,
        "bracket": bracket,
    }
    if pareto:
        settings["prior"] = believed
        write_pareto(output.parent, None if every else criterion, rig, settings)
        return
    make = partial(
        make_plan,
        rig,
        views=views or both_views,
        lights=lights or both_lights,
        criterion=criterion,
        **settings,
    )
    if use.given:
        fewest = shots is None and not (views or lights or given)
        field_of = partial(field_within, rig, light_set, view_set, max_theta_deg)
        plan = use.plan(make, field_of, believed, shots, fewest=fewest)
    else:
        plan = make(shots=shots, hours=hours, prior=believed)
    plan = use.finish(plan)
    if believed.cache_info().currsize:
        plan = with_prior(plan, believed())
    elif prior:
        click.echo("note: all pairs are measured, so the prior had no say")
    plan.save(output)
    print_plan(plan)
    click.echo(f"wrote {output}, sha256 {plan.sha256}")
    if len(plan.shots) < MIN_SAMPLES:
        click.echo(f"note: gonio reconstruct needs at least {MIN_SAMPLES} shots")
    if page:
        _write_page(page_path, plan, rig, (light_set, view_set), max_theta_deg)
        click.echo(f"wrote {page_path}")
    if plot:
        _draw(plan, plot, view_set, light_set)
        click.echo(f"wrote {plot}")
    use.draw()


def _refuse_idle(criterion: str, weight: str, seed: int | None, prior_path: Path | None) -> None:
    """Refuse options that the criterion would not look at."""
    from gonio.errors import BadInputError
    from planner.criteria import CRITERIA, PRIOR_CRITERIA

    if criterion not in CRITERIA:
        return
    if prior_path and criterion not in PRIOR_CRITERIA:
        raise BadInputError(f"criterion {criterion} knows no prior; leave out --prior")
    if weight != "alike" and criterion != "i-optimal":
        raise BadInputError(f"criterion {criterion} weighs no pairs; leave out --weight")
    if seed is not None and criterion != "random":
        raise BadInputError(f"criterion {criterion} draws nothing; leave out --seed")


def _write_page(
    path: Path,
    plan: Plan,
    rig: Rig,
    sides: tuple[Candidates, Candidates],
    max_theta_deg: float | None,
) -> None:
    from gonio.report.plan_page import write_plan_page
    from planner.reach import reach_of

    write_plan_page(path, plan, rig, *sides, reach_of(*sides, rig, max_theta_deg).reasons)


def _draw(plan: Plan, path: Path, views: Candidates, lights: Candidates) -> None:
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
