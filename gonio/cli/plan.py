"""`gonio plan`: choose what to measure, and in which order."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from gonio.cli._json import answers
from gonio.cli._numbers import FiniteRange
from gonio.cli._scene import scene_options

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
    type=FiniteRange(min=0, min_open=True, max=10_000),
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
    "--anchors",
    type=click.IntRange(min=2),
    metavar="N",
    help="Take one pair again before each N shots and at the end, to see whether the rig drifts; "
    "50 is a good number.  [default: no anchors]",
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
@answers
def command(**options: Any) -> None:
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
        gonio plan --anchors 50                  with one pair repeated, to see drift
        gonio plan --pareto                      how many shots are worth their time
        gonio plan --continue session/ --shots 20
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.cli._console import note
    from gonio.cli._plan_request import PlanCommand

    context = click.get_current_context()
    left = {
        name
        for name in ("density", "criterion")
        if context.get_parameter_source(name) is ParameterSource.DEFAULT
    }
    if "density" in left:
        options["density"] = None
    PlanCommand(every="criterion" in left, tell=note, **options).run()
