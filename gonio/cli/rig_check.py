"""`gonio rig check`: look at every device of a rig."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.table import Table

    from gonio.bench import Finding
    from gonio.capture import Instrument
    from gonio.rig import Rig


@click.command(name="check")
@click.option(
    "--rig",
    "rig_path",
    type=click.Path(path_type=Path),
    help="The rig's file; needed but for --sim.",
)
@click.option("--sim", is_flag=True, help="Look at the simulated twin of the rig.")
@click.option(
    "--exercise",
    is_flag=True,
    help="Then also enable the drives where they stand, light each lamp faintly, and take a dark "
    "frame. Nothing moves.",
)
@answers
def command(*, rig_path: Path | None, sim: bool, exercise: bool) -> None:
    """Look at every device, and say what to do about what is wrong; exits 3 if anything is.

    Nothing is changed: registers, lamps and folder are only read. With --exercise everything is
    used after that, in small.

    \b
    Examples:
        gonio rig check --rig rig.toml
        gonio rig check --rig rig.toml --exercise
    """  # noqa: D301
    import tempfile

    from gonio.bench import exercise as use
    from gonio.bench import look_over
    from gonio.cli._console import console
    from gonio.errors import BadInputError, DeviceFaultError
    from gonio.rig import default_rig, load_rig
    from gonio.words import several

    if rig_path is None and not sim:
        raise BadInputError("which rig? give its file with --rig, or add --sim")
    rig = load_rig(rig_path) if rig_path else default_rig()
    with _instrument(rig, sim=sim) as instrument, tempfile.TemporaryDirectory() as scratch:
        found = list(look_over(instrument, _local(rig, scratch) if sim else rig))
        if exercise:
            found += use(instrument, rig, Path(scratch))
    console.print(_table(found))
    answer({"findings": list(map(_document, found))})
    wrong = [each for each in found if not each.is_well]
    if not wrong:
        console.print("all is well")
        return
    raise DeviceFaultError(f"{several(len(wrong), 'thing')} to see to")


@contextlib.contextmanager
def _instrument(rig: Rig, *, sim: bool) -> Iterator[Instrument]:
    if sim:
        from gonio.api.twin import simulated_rig

        with simulated_rig(rig, 0) as (instrument, _, _):
            yield instrument
    else:
        from gonio.capture.hardware import connected

        with connected(rig) as instrument:
            yield instrument


def _local(rig: Rig, folder: str) -> Rig:
    """Return the rig with a folder that is there: the twin's own is made where it is needed."""
    return rig.model_copy(update={"camera": rig.camera.model_copy(update={"folder": folder})})


def _document(finding: Finding) -> dict[str, object]:
    return {
        "is_well": finding.is_well,
        "device": finding.device,
        "what": finding.what,
        "found": finding.found,
        "remedy": finding.remedy,
    }


def _table(found: list[Finding]) -> Table:
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    for name in ("", "device", "", "found", "what to do"):
        table.add_column(name)
    for each in found:
        sign = "[green]ok[/]" if each.is_well else "[red]--[/]"
        table.add_row(sign, each.device, each.what, each.found, each.remedy)
    return table
