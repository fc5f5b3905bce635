"""`gonio capture`: measure a plan."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._imperfections import imperfections_option

if TYPE_CHECKING:
    from sim.faults import Fault

_OF_THE_TWIN = {
    "material": "--material",
    "seed": "--seed",
    "faults_path": "--faults",
    "imperfections": "--imperfections",
    "rehearse": "--rehearse",
}


def _material(text: str) -> str:
    """Return an embedded name in the case that it has, a path as it is."""
    return text if Path(text).suffix else text.lower()


@click.command(name="capture")
@click.option("--sim", is_flag=True, help="Use the simulated twin of the rig, on a virtual clock.")
@click.option(
    "--material",
    type=_material,
    metavar="NAME|FILE",
    help="With --sim, what the twin carries: a name from `gonio materials`, or a file: an "
    "npz table of 81 x 81 directions, or one that gonio import reads.  [default: wood-veneer]",
)
@click.option(
    "--seed", type=click.IntRange(min=0), help="With --sim, seed of all noise.  [default: 0]"
)
@imperfections_option
@click.option(
    "--faults",
    "faults_path",
    type=click.Path(path_type=Path),
    help="With --sim, a file of what goes wrong and when (docs/topics/faults.md).",
)
@click.option(
    "--rehearse",
    is_flag=True,
    default=None,
    help="With --sim, go through every move, exposure and fault without rendering a frame, to see "
    "what the plan takes.",
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
    "--retake",
    is_flag=True,
    help="Go on with the session in the output folder, and take the shots again that the checks "
    "of gonio reduce flagged.",
)
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
@click.option(
    "--calibration",
    "calibration_path",
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="A camera's calibration that gonio calibrate made; a copy goes into the session, and the "
    "reduction corrects by it.  [default: none]",
)
@click.option(
    "--max-age",
    "max_age_days",
    type=click.FloatRange(min=0),
    metavar="DAYS",
    help="With --calibration, how old it may be.  [default: 30]",
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
    imperfections: str | None,
    faults_path: Path | None,
    rehearse: bool | None,
    plan_path: Path | None,
    rig_path: Path | None,
    output: Path,
    resume: bool,
    retake: bool,
    adaptive: bool,
    until: float | None,
    batch: int | None,
    max_shots: int | None,
    hours: float | None,
    prior_path: Path | None,
    calibration_path: Path | None,
    max_age_days: float | None,
    sample: str | None,
    orientation: str,
    mounting: str,
    operator: str,
    temperature_c: float | None,
) -> None:
    """Measure a plan: dark frames, the white reference at 0:45, then every shot.

    On a real rig, its file says where arm, lamps and camera are; look it over first with gonio rig
    check. Ctrl-C stops arms and lamps in order.

    A capture that was stopped, however it was, goes on with --resume: frames that are
    there with the content the journal vouches for are not taken again. With --retake, shots that
    a check of gonio reduce flagged are.

    \b
    Examples:
        gonio capture --sim
        gonio capture --sim --material brushed-metal -o metal/
        gonio capture --sim --imperfections mild --calibration calibration/
        gonio capture --sim --resume
        gonio capture --sim --rehearse --plan all.json -o rehearsal/
        gonio capture --sim --adaptive --until 0.1 --max-shots 200
        gonio capture --rig rig.toml -o leather/ --sample "calf leather"
        gonio capture --resume -o leather/
        gonio capture --retake -o leather/
    """  # noqa: D301
    from gonio.capture.retake import flagged
    from gonio.cli._adaptive import Wish, measure_adaptively
    from gonio.cli._begin import Carried, begun
    from gonio.cli._calibration import asked_for
    from gonio.cli._measure import NOT_NOTED, driven, measure
    from gonio.cli._rehearsal import check_begun_so, check_shown_nothing
    from gonio.cli._resume import refuse_notes, resumed
    from gonio.cli._retake import without_suspects

    said = {"until": until, "batch": batch, "max_shots": max_shots, "hours": hours}
    wish = Wish.of(said, prior_path, adaptive=adaptive)
    resume = resume or retake
    _check_options(sim=sim, resume=resume, rig_path=rig_path)
    if rehearse:
        check_shown_nothing(material, adaptive=adaptive)
    faults = _faults(faults_path)
    calibration = asked_for(calibration_path, max_age_days, resume=resume)
    if resume:
        refuse_notes()
        asked = (material, seed, imperfections)
        session, twin = resumed(output, plan_path, rig_path, asked, sim=sim)
        if rehearse:
            check_begun_so(session)
        goal = wish.going_on(session)
        if retake:
            flagged(session)  # one without checks is refused before anything moves
    else:
        carried = Carried.of(material, seed, imperfections) if sim else None
        notes = {
            "sample": sample or (carried.described if carried else NOT_NOTED),
            "orientation": orientation,
            "mounting": mounting,
            "operator": operator,
            "temperature_c": temperature_c,
            "rehearsal": bool(rehearse),
        }
        goal = wish.goal()
        session = begun(output, plan_path, rig_path, carried, notes, goal, calibration)
        twin = carried.settings if carried else None
    rig = driven(session, twin, faults)
    if retake:
        rig = without_suspects(session, rig)
    if goal is None:
        measure(session, rig)
    else:
        measure_adaptively(session, rig, goal)


def _check_options(*, sim: bool, resume: bool, rig_path: Path | None) -> None:
    """Refuse options of the twin without it, and a real rig that nobody has named."""
    from gonio.errors import BadInputError

    context = click.get_current_context()
    for name, option in _OF_THE_TWIN.items():
        if not sim and context.params[name] is not None:
            raise BadInputError(f"{option} is an option of --sim; add that, or leave it out")
    if not (sim or resume or rig_path):
        raise BadInputError(
            "which rig? give its file with --rig, or add --sim to measure on the simulated one"
        )


def _faults(path: Path | None) -> tuple[Fault, ...]:
    from sim.faults import load_faults

    return () if path is None else load_faults(path)
