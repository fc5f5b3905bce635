"""`gonio rig bench`: measure what a rig takes."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.table import Table

    from gonio.bench import Bench
    from gonio.capture import Instrument, Operator
    from gonio.rig import Rig
    from gonio.timing import Spread

_CLEARLY = 0.05


@click.command(name="bench")
@click.option("--sim", is_flag=True, help="Use the simulated twin of the rig, on a virtual clock.")
@click.option(
    "--rig", "rig_path", type=click.Path(path_type=Path), help="A rig file.  [default: built in]"
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="With --sim, of noise."
)
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="The file; one there is replaced.  [default: rig-timing.json, beside the rig file]",
)
@answers
def command(*, sim: bool, rig_path: Path | None, seed: int, output: Path | None) -> None:
    """Measure what a rig takes, so that plans tell their time and exposures well.

    Lay the white reference in the holder. Each axis is homed and moved over short and long ways,
    both ways round, with the other arm out of the way; then frames of every exposure are taken at
    0:45. Velocity, acceleration and jerk are fitted to the times. It takes about ten minutes
    on the twin's clock. gonio plan finds the file beside the rig file or in the current folder.

    \b
    Examples:
        gonio rig bench --sim
        gonio rig bench --rig rig.toml
    """  # noqa: D301
    from gonio.bench import bench_rig
    from gonio.cli._console import console, progress_bar
    from gonio.errors import BadInputError
    from gonio.rig import default_rig, load_rig
    from gonio.timing import TIMING_NAME
    from gonio.words import duration

    if not (sim or rig_path):
        raise BadInputError(
            "which rig? give its file with --rig, or add --sim to measure the simulated one"
        )
    rig = load_rig(rig_path) if rig_path else default_rig()
    target = output or (rig_path.parent if rig_path else Path()) / TIMING_NAME
    with (
        _driven(rig, seed, sim=sim) as (instrument, operator, scratch),
        progress_bar("measuring") as progress,
    ):
        bench = bench_rig(instrument, operator, rig, scratch, progress)
        took_s = instrument.clock.now()
    bench.timing.save(target)
    console.print(_axes(bench))
    console.print(_rest(bench))
    for note in _notes(bench, rig):
        click.echo(f"note: {note}")
    click.echo(f"wrote {target} after {duration(took_s)} of rig time, sha256 {bench.timing.sha256}")
    timing = bench.timing.model_dump(mode="json", exclude={"schema_"})
    answer({"file": target, "took_s": took_s, "notes": _notes(bench, rig), **timing})


@contextmanager
def _driven(rig: Rig, seed: int, *, sim: bool) -> Iterator[tuple[Instrument, Operator, Path]]:
    """Connect to the rig or to its twin; yields a folder for frames as well."""
    if sim:
        from gonio.api.twin import simulated_rig

        with simulated_rig(rig, seed) as driven:
            yield driven
        return
    import tempfile

    from gonio.capture.hardware import hardware

    with tempfile.TemporaryDirectory() as scratch, hardware(rig) as (instrument, operator):
        yield instrument, operator, Path(scratch)


def _axes(bench: Bench) -> Table:
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    table.add_column("axis")
    for name in ("latency s", "deg/s", "deg/s2", "deg/s3", "residual s", "then still after s"):
        table.add_column(name, justify="right")
    for name, axis in bench.axes.items():
        fit = axis.profile
        table.add_row(
            name,
            f"{fit.latency_s:.3f}",
            f"{fit.velocity_deg_s:.4g}",
            f"{fit.acceleration_deg_s2:.4g}",
            f"{fit.jerk_deg_s3:.3g}" if fit.jerk_deg_s3 else "trapezoid",
            f"{fit.residual_s:.4f}",
            _plus_minus(axis.timing.settle),
        )
    return table


def _rest(bench: Bench) -> Table:
    from rich.table import Table

    frames = bench.frames
    table = Table(show_header=False, box=None, pad_edge=False)
    for name, axis in bench.axes.items():
        speed, rest_s = axis.timing.homing_velocity_deg_s, axis.timing.homing_s
        table.add_row(f"homing {name}", f"{speed:.3g} deg/s, and {rest_s:.2f} s")
    table.add_row("start and end beside homing", f"{_plus_minus(frames.startup)} s")
    table.add_row("lamps of a shot", f"{_plus_minus(frames.lamps)} s")
    table.add_row("a frame beside its exposure", f"{_plus_minus(frames.hold)} s")
    table.add_row("then until its file is there", f"{_plus_minus(frames.read_out)} s")
    table.add_row("white at 0:45 fills the range in", f"{frames.white_level_s:.4g} s")
    return table


def _plus_minus(time: Spread) -> str:
    return f"{time.mean_s:.3f} +- {time.sd_s:.3f}"


def _notes(bench: Bench, rig: Rig) -> list[str]:
    """Say where an axis acts clearly otherwise than its rig file says."""
    notes = []
    for name, axis in bench.axes.items():
        spec = rig.axis[name]
        for what, found, said in (
            ("velocity", axis.profile.velocity_deg_s, spec.max_velocity_deg_s),
            ("acceleration", axis.profile.acceleration_deg_s2, spec.max_acceleration_deg_s2),
        ):
            if abs(found / said - 1.0) > _CLEARLY:
                notes.append(f"{name}: {what} is {found:.3g}, and the rig file says {said:g}")
    return notes
