"""`gonio rig home`: find the axes' positions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers
from gonio.cli._rig_option import rig_option

if TYPE_CHECKING:
    from pathlib import Path


@click.command(name="home")
@rig_option
@click.option("--anew", is_flag=True, help="Also axes that know their position.")
@answers
def command(*, rig_path: Path, anew: bool) -> None:
    """Find the positions of all axes that do not know theirs; then the drives let go.

    The axes run to their home switches, all at once, so keep clear of both arms.

    \b
    Examples:
        gonio rig home --rig rig.toml
        gonio rig home --rig rig.toml --anew
    """  # noqa: D301
    from gonio.capture.hardware import connected
    from gonio.rig import AXES, load_rig

    with connected(load_rig(rig_path)) as instrument, instrument.arm_ready() as arm:
        arm.home(AXES if anew else ())
        angles_deg = arm.angles_deg()
        for name, angle in angles_deg.items():
            click.echo(f"{name:12} {angle:9.3f} deg")
        answer({"angles_deg": angles_deg})
