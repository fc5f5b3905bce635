"""`gonio rig stop`: stop everything, whoever drives it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers
from gonio.cli._rig_option import rig_option

if TYPE_CHECKING:
    from pathlib import Path


@click.command(name="stop")
@rig_option
@answers
def command(*, rig_path: Path) -> None:
    """Stop all axes, switch the lamps off, and end the gonio that drives the rig, if there is one.

    Every axis is told first; only then anything is waited for. A capture that is ended so can be
    resumed. This is no emergency stop: that is a button that cuts the power.

    \b
    Example:
        gonio rig stop --rig rig.toml
    """  # noqa: D301
    from gonio.cli._stop import stop_rig
    from gonio.rig import load_rig

    done: list[str] = []
    answer({"done": done})
    for line in stop_rig(load_rig(rig_path)):
        click.echo(line)
        done.append(line)
