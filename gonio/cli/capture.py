"""`gonio capture`: measure a plan."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

if TYPE_CHECKING:
    from gonio.adaptive import Goal
    from gonio.cli._twin import TwinSettings
    from gonio.plan import Plan
    from gonio.rig import Rig
    from gonio.session import Session

_DEFAULT_PLAN = Path("plan.json")
_MATERIAL = "wood-veneer"
_NOTES = {
    "sample": "--sample",
    "orientation": "--orientation",
    "mounting": "--mounting",
    "operator": "--operator",
    "temperature_c": "--temperature",
}


def _material(text: str) -> str:
    """Return an embedded name in the case that it has, a path as it is."""
    return text if text.endswith(".npz") else text.lower()


@click.command(name="capture")
@click.option("--sim", is_flag=True, help="Use the simulated twin of the rig, on a virtual clock.")
@click.option(
    "--material",
    type=_material,
    metavar="NAME|FILE",
    help="With --sim, what the twin carries: a name from `gonio materials`, or an .npz table of "
    "81 x 81 directions.  [default: wood-veneer]",
)
@click.option(
    "--seed", type=click.IntRange(min=0), help="With --sim, seed of all noise.  [default: 0]"
)
@click.option(
    "--plan",
    "plan_path",
    type=click.Path(path_type=Path),
    help="The plan to measure.  [default: plan.json where there is one, else density sixth]",
)
@click.option(
    "--rig", "rig_path", type=click.Path(path_type=Path), help="A rig file.  [default: built in]"
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default=Path("session"),
    show_default=True,
    help="The session's folder; an existing one is never overwritten.",
)
@click.option("--resume", is_flag=True, help="Go on with the session in the output folder.")
@click.option(
    "--adaptive",
    is_flag=True,
    help="Choose further shots by what was measured, round by round, until the target or a limit; "
    "begins with a plan of 32 pairs unless there is another.",
)
@click.option(
    "--until",
    type=float,
    metavar="SD",
    help="With --adaptive, the target: mean posterior standard deviation of ln(f + 0.01 white) "
    "over the 81 x 81 pairs.  [default: 0.05]",
)
@click.option(
    "--batch", type=int, metavar="N", help="With --adaptive, shots of a round.  [default: 16]"
)
@click.option(
    "--max-shots", type=int, metavar="N", help="With --adaptive, shots in all.  [default: no limit]"
)
@click.option(
    "--hours", type=float, help="With --adaptive, hours of rig time in all.  [default: no limit]"
)
@click.option(
    "--prior",
    "prior_path",
    type=click.Path(dir_okay=False, path_type=Path),
    help="With --adaptive, what materials look like (see gonio prior).  [default: generated ones]",
)
@click.option("--sample", help="Name of the sample, for the notes.")
@click.option("--orientation", default="marked edge along +x", show_default=True)
@click.option("--mounting", default="flat in the holder", show_default=True)
@click.option("--operator", default="not noted", show_default=True, help="Who measures.")
@click.option("--temperature", "temperature_c", type=float, help="Room temperature in deg C.")
def command(
    *,
    sim: bool,
    material: str | None,
    seed: int | None,
    plan_path: Path | None,
    rig_path: Path | None,
    output: Path,
    resume: bool,
    adaptive: bool,
    until: float | None,
    batch: int | None,
    max_shots: int | None,
    hours: float | None,
    prior_path: Path | None,
    sample: str | None,
    orientation: str,
    mounting: str,
    operator: str,
    temperature_c: float | None,
) -> None:
    """Measure a plan: dark frames, the white reference at 0:45, then every shot.

    A capture that was stopped, however it was, goes on with --resume: frames that are
    there with the content the journal vouches for are not taken again.

    \b
    Examples:
        gonio capture --sim
        gonio capture --sim --material brushed-metal -o metal/
        gonio capture --sim --resume
        gonio capture --sim --adaptive --until 0.1 --max-shots 200
    """  # noqa: D301
    from gonio.cli._adaptive import Wish, measure_adaptively
    from gonio.errors import BadInputError

    said = {"until": until, "batch": batch, "max_shots": max_shots, "hours": hours}
    wish = Wish.of(said, prior_path, adaptive=adaptive)
    if not sim:
        raise BadInputError(
            "this version drives the simulated rig only; add --sim to measure with it"
        )
    if resume:
        _refuse_notes()
        session, settings = _resumed(output, plan_path, rig_path, material, seed)
        goal = wish.going_on(session)
    else:
        notes = {
            "sample": sample or f"{Path(material or _MATERIAL).stem} (simulated)",
            "orientation": orientation,
            "mounting": mounting,
            "operator": operator,
            "temperature_c": temperature_c,
        }
        goal = wish.goal()
        session, settings = _created(output, plan_path, rig_path, material, seed, notes, goal)
    if goal is None:
        _measure(session, settings)
    else:
        measure_adaptively(session, settings, goal)


def _refuse_notes() -> None:
    """Refuse notes on a resume, which keeps those that the session was begun with."""
    from gonio.errors import ResumeRefusedError

    context = click.get_current_context()
    for name, option in _NOTES.items():
        if context.get_parameter_source(name) == ParameterSource.COMMANDLINE:
            raise ResumeRefusedError(
                f"{option}: the notes are those that the session was begun with; leave it out"
            )


def _resumed(
    root: Path,
    plan_path: Path | None,
    rig_path: Path | None,
    material: str | None,
    seed: int | None,
) -> tuple[Session, TwinSettings]:
    from gonio.cli._twin import recall
    from gonio.plan import Plan
    from gonio.rig import load_rig
    from gonio.session import Session

    session = Session.open(root)
    plan = Plan.load(plan_path) if plan_path else None
    if plan is not None and plan.parent is not None and plan not in session.chain().plans:
        with session.lock():
            session.add_plan(plan, plan_path)
    session.check_same(plan, load_rig(rig_path) if rig_path else None)
    return session, recall(session, material, seed)


def _created(
    root: Path,
    plan_path: Path | None,
    rig_path: Path | None,
    material: str | None,
    seed: int | None,
    said: dict[str, Any],
    goal: Goal | None,
) -> tuple[Session, TwinSettings]:
    from gonio.capture import check_reach, check_space
    from gonio.cli._adaptive import check_affordable, note_goal
    from gonio.cli._twin import TwinSettings, remember
    from gonio.creation import create_session
    from gonio.materials import reference_material
    from gonio.notes import Notes
    from gonio.rig import default_rig, default_rig_text, load_rig
    from gonio.validation import check
    from sim.materials import load_material

    rig = load_rig(rig_path) if rig_path else default_rig()
    rig_text = rig_path.read_text(encoding="utf-8") if rig_path else default_rig_text()
    notes = check(Notes, said, Path("notes"), "correct the option of that name")
    # what cannot be measured is refused before anything is written
    carried = load_material(material or _MATERIAL)
    reference_material(rig)
    settings = TwinSettings.of(material or _MATERIAL, seed or 0)
    plan = _plan_for(plan_path, rig, rig_path, goal)
    check_reach(plan.shots, rig)
    remedy = "free some space or choose another folder with -o"
    check_space(root, plan.estimates.frames, rig, remedy)
    if goal:
        check_affordable(plan, goal)

    def furnish(session: Session) -> None:
        remember(session, settings, carried)
        if goal:
            note_goal(session, goal)

    return create_session(root, plan, rig_text, notes, furnish), settings


def _plan_for(path: Path | None, rig: Rig, rig_path: Path | None, goal: Goal | None) -> Plan:
    """Return the plan asked for, or plan.json, or a fresh one: `sixth`, or few pairs to begin."""
    from gonio.cli._adaptive import first_shots
    from gonio.cli._prior import material_prior, with_prior
    from gonio.cli._timing import timing_for
    from gonio.plan import Plan
    from planner.make import make_plan

    found = path or (_DEFAULT_PLAN if _DEFAULT_PLAN.exists() else None)
    if found is not None:
        return Plan.load(found)
    shots = first_shots(goal) if goal else None
    what = f"begins with {shots} pairs" if shots else "measures density sixth"
    click.echo(f"no plan.json here, so this {what} (see gonio plan --help)")
    timing = timing_for(rig, rig_path, None)
    prior = material_prior(goal.prior_path if goal else None)
    plan = make_plan(
        rig,
        criterion="i-optimal",
        shots=shots,
        prior=lambda: prior,
        timing=timing,
        bracket="predicted" if timing else "all",
    )
    return with_prior(plan, prior)


def _measure(session: Session, settings: TwinSettings) -> None:
    from gonio.capture import Capture
    from gonio.cli._console import progress_bar
    from gonio.cli._twin import simulated

    began = time.perf_counter()
    with (
        session.lock(),
        session.journal(writing=True) as journal,
        simulated(session, settings) as (instrument, operator),
        progress_bar("capturing") as progress,
    ):
        start_s = instrument.clock.now()
        frames = Capture(session, instrument, operator, journal).run(progress)
        took_s = instrument.clock.now() - start_s
        if frames:
            before = session.timings().get("capture", 0.0)
            session.note_timing("capture", before + time.perf_counter() - began)
    _report(session, settings, frames, took_s)


def _report(session: Session, settings: TwinSettings, frames: int, took_s: float) -> None:
    from gonio.cli._console import console
    from gonio.score import score_of
    from gonio.words import duration

    if not frames:
        console.print(f"{session.root}: nothing left to take; the session is complete")
        return
    chain, name = session.chain(), Path(settings.material).stem
    console.print(
        f"{session.root}: {frames} frames of {name} in {duration(took_s)} of rig time "
        f"(whole plan estimated at {duration(chain.estimated_s)})"
    )
    score = score_of(session) if len(chain.plans) == 1 else None
    if score is not None:
        console.print(f"that is {score.sentence}")
    console.print(f"next: gonio reconstruct {session.root}")
