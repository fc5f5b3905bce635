"""`gonio capture`: measure a plan."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from gonio.cli._twin import TwinSettings
    from gonio.plan import Plan
    from gonio.rig import Rig
    from gonio.session import Session

_DEFAULT_PLAN = Path("plan.json")


@click.command(name="capture")
@click.option("--sim", is_flag=True, help="Use the simulated twin of the rig, on a virtual clock.")
@click.option(
    "--material",
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
    """  # noqa: D301
    from gonio.cli._twin import DEFAULT_MATERIAL, TwinSettings, recall, remember
    from gonio.errors import BadInputError
    from gonio.plan import Plan
    from gonio.rig import default_rig, default_rig_text, load_rig
    from gonio.session import Notes, Session
    from sim.materials import load_material

    if not sim:
        raise BadInputError(
            "this version drives the simulated rig only; add --sim to measure with it"
        )
    rig = load_rig(rig_path) if rig_path else default_rig()
    if resume:
        session = Session.open(output)
        plan = Plan.load(plan_path) if plan_path else None
        session.check_same(plan, rig if rig_path else None)
        settings = recall(session, material, seed)
    else:
        settings = TwinSettings(material=material or DEFAULT_MATERIAL, seed=seed or 0)
        notes = Notes(
            sample=sample or f"{Path(settings.material).stem} (simulated)",
            orientation=orientation,
            mounting=mounting,
            operator=operator,
            temperature_c=temperature_c,
        )
        rig_text = rig_path.read_text(encoding="utf-8") if rig_path else default_rig_text()
        # a bad material is refused before anything is written
        carried = load_material(settings.material)
        session = Session.create(output, _plan_for(plan_path, rig), rig_text, notes)
        remember(session, settings, carried)
    _measure(session, settings)


def _plan_for(path: Path | None, rig: Rig) -> Plan:
    """Return the plan asked for, or plan.json, or a fresh `sixth`."""
    from gonio.plan import Plan
    from planner.make import make_plan

    found = path or (_DEFAULT_PLAN if _DEFAULT_PLAN.exists() else None)
    if found is not None:
        return Plan.load(found)
    click.echo("no plan.json here, so this measures density sixth (see gonio plan --help)")
    return make_plan(rig)


def _measure(session: Session, settings: TwinSettings) -> None:
    from gonio.capture import Capture
    from gonio.cli._console import progress_bar
    from gonio.cli._twin import simulated

    began = time.perf_counter()
    with (
        session.lock(),
        session.journal(must_exist=False) as journal,
        simulated(session, settings) as (instrument, operator),
        progress_bar("capturing") as progress,
    ):
        start_s = instrument.clock.now()
        frames = Capture(session, instrument, operator, journal).run(progress)
        took_s = instrument.clock.now() - start_s
    session.note_timing("capture", time.perf_counter() - began)
    _report(session, settings, frames, took_s)


def _report(session: Session, settings: TwinSettings, frames: int, took_s: float) -> None:
    from gonio.cli._console import console, duration

    if not frames:
        console.print(f"{session.root}: nothing left to take; the session is complete")
        return
    expected = session.chain()[-1].estimates.total_s
    console.print(
        f"{session.root}: {frames} frames of {settings.material} in {duration(took_s)} of rig time "
        f"(whole plan estimated at {duration(expected)})"
    )
    console.print(f"next: gonio reconstruct {session.root}")
