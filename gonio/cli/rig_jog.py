"""`gonio rig jog`: move one axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers
from gonio.cli._rig_option import rig_option

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.rig import Rig


@click.command(name="jog", context_settings={"ignore_unknown_options": True})
@click.argument("axis", metavar="AXIS")
@click.argument("degrees", type=float, metavar="DEGREES")
@rig_option
@click.option("--to", "is_goal", is_flag=True, help="DEGREES is the angle to go to, not the way.")
@answers
def command(*, axis: str, degrees: float, rig_path: Path, is_goal: bool) -> None:
    """Move AXIS by DEGREES, or --to an angle; then the drives let go.

    AXIS is view_theta, view_phi, light_theta or light_phi. What would leave the travel, enter a
    box or bring the arms too near to each other is refused, and so is an axis that is not homed.

    \b
    Examples:
        gonio rig jog view_theta +5 --rig rig.toml
        gonio rig jog light_phi -10 --rig rig.toml
        gonio rig jog view_theta 45 --to --rig rig.toml
    """  # noqa: D301
    import math

    from gonio.capture.hardware import connected
    from gonio.errors import BadInputError
    from gonio.rig import AXES, load_rig

    if axis not in AXES:
        raise BadInputError(f"there is no axis {axis!r}; use {', '.join(AXES)}")
    if not math.isfinite(degrees):
        raise BadInputError(f"{degrees} is no angle; give degrees")
    rig = load_rig(rig_path)
    with connected(rig) as instrument, instrument.arm_ready() as arm:
        arm.check_homed()
        here = arm.angles_deg()
        goal = degrees if is_goal else here[axis] + degrees
        rig.check_reach(axis, goal)
        _check_clear(here, here | {axis: goal}, rig)
        arm.move({axis: goal})
        angles_deg = arm.angles_deg()
        click.echo(f"{axis} {angles_deg[axis]:.3f} deg")
        answer({"axis": axis, "angles_deg": angles_deg})


def _check_clear(start: dict[str, float], goal: dict[str, float], rig: Rig) -> None:
    import numpy as np

    from gonio.clearance import BEYOND_TRAVEL, not_free, spoken
    from gonio.errors import BadInputError
    from gonio.paths import blocked
    from gonio.rig import AXES

    here, there = (np.array([[pose[name] for name in AXES]]) for pose in (start, goal))
    # other axes may stand at their home switches, beyond the travel
    for reason, short in not_free(there, rig).items():
        if short[0] and reason != BEYOND_TRAVEL:
            raise BadInputError(f"{spoken(there[0])} is {reason}; go elsewhere")
    if blocked(here, there, rig)[0]:
        raise BadInputError(
            "on the way there the arms come too near to each other or to a box; move another axis "
            "first"
        )
