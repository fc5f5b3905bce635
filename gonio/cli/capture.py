"""`gonio capture`: measure a plan."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from gonio.cli._imperfections import imperfections_option
from gonio.cli._json import answers


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
@answers
def command(*, resume: bool, retake: bool, plan_path: Path | None, **options: Any) -> None:
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
    from gonio.api.capturing import CaptureRequest
    from gonio.cli._console import note
    from gonio.cli._ending import take
    from gonio.cli._resume_notes import refuse_notes

    request = CaptureRequest(plan=plan_path, **options)
    if resume or retake:
        refuse_notes()
        take(request.resume(retake=retake), retake=retake)
    else:
        take(request.begin(note), retake=False)
