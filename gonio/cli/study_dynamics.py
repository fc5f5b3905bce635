"""`gonio study dynamics`: the physics of an axis, integrated and held to bounds."""

from __future__ import annotations

from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers
from gonio.cli._numbers import FiniteRange

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from gonio.protocols import Progress
    from gonio.report.drawings import Drawing
    from gonio.report.dynamics import Bound, Run
    from sim.dynamics.findings import Finding

    Cases = dict[str, Callable[[], Iterable[Finding]]]

TITLE = "Dynamics"
ABOUT = (
    "One axis of the arm: a motor with an electrical and a mechanical time constant, friction, a "
    "gear with backlash, an arm that bends, its weight, end stops and warmth. How exactly and how "
    "fast it is integrated, and whether extreme cases keep their bounds."
)
PARTS = ("race", "bounds")


@click.command(name="dynamics")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default=Path("study"),
    show_default=True,
    help="Folder of the page.",
)
@click.option(
    "--days",
    type=FiniteRange(0.05, 365.0),
    default=7.0,
    show_default=True,
    help="Simulated days of moves whose energy and positions are followed.",
)
@click.option(
    "--methods", metavar="NAMES", help="Who races: exponential, LSODA, Radau, RK45.  [default: all]"
)
@click.option("--cases", metavar="NAMES",
              help="Of the extreme cases: swing, step, locked, creep, inertia, stop, reversal, "
              "work.  [default: all]")  # fmt: skip
@answers
def command(*, output: Path, days: float, methods: str | None, cases: str | None) -> None:
    """Show how exactly the arm's motion is integrated, against run time, and in extreme cases.

    \b
    Examples:
        gonio study dynamics
        gonio study dynamics --days 30 --cases work -o month/
    """  # noqa: D301
    from gonio.cli._console import progress_bar
    from gonio.cli._study import names_in
    from gonio.errors import BadInputError

    if output.exists() and not output.is_dir():
        raise BadInputError(f"{output} is a file; give a folder for the study")
    racing, known = {name.lower(): name for name in _tolerances()}, _cases(days)
    chosen = [racing[name] for name in names_in(methods, list(racing), "method")]
    held = {name: known[name] for name in names_in(cases, list(known), "case")}
    try:
        with progress_bar("integrating") as progress:
            runs, bounds = _measured(chosen, held, progress)
    except KeyboardInterrupt as stop:
        stop.args = ("nothing is kept, and the same command begins anew",)
        raise
    _write(output, runs, bounds)


def _write(output: Path, runs: list[Run], bounds: list[Bound]) -> None:
    from gonio.cli._console import console
    from gonio.cli._study_end import show_grids, write_grid
    from gonio.report.dynamics import bounds_grid, race_grid
    from gonio.report.grids import Section
    from gonio.report.study import write_study

    grids = (race_grid(runs), bounds_grid(bounds))
    output.mkdir(parents=True, exist_ok=True)
    for part, grid in zip(PARTS, grids, strict=True):
        write_grid(output / f"dynamics-{part}.csv", grid)
    page = output / "dynamics.html"
    section = Section("One axis", tuple(_drawings(runs)), grids)
    write_study(page, TITLE, ABOUT, [section], _notes())
    show_grids(section.title, grids)
    kept = sum(bound.holds for bound in bounds)
    console.print(f"{kept} of {len(bounds)} bounds hold")
    console.print(f"tables: {output}/dynamics-*.csv")
    console.print(f"page:   {page}")
    answer({"page": page, "race": list(map(asdict, runs)), "bounds": list(map(asdict, bounds))})


def _tolerances() -> dict[str, tuple[float, ...]]:
    from sim.dynamics.race import TOLERANCES

    return TOLERANCES


def _cases(days: float) -> Cases:
    from sim.dynamics import cases, held

    return {
        "swing": held.undamped_week,
        "step": held.any_step,
        "locked": held.locked_rotor,
        "creep": cases.creep,
        "inertia": cases.inertia,
        "stop": cases.stop,
        "reversal": cases.reversal,
        "work": partial(cases.work, days),
    }


def _measured(
    methods: list[str], cases: Cases, progress: Progress
) -> tuple[list[Run], list[Bound]]:
    from gonio.report.dynamics import Bound, Run
    from sim.dynamics.race import race

    tolerances = {name: _tolerances()[name] for name in methods}
    total = sum(map(len, tolerances.values())) + len(cases)
    runs, bounds = [], []
    progress(0, total)
    for done, one in enumerate(race(tolerances), 1):
        micro = 1e6 * one.error_rad
        times = one.seconds, one.first_seconds
        runs.append(Run(one.method, one.tolerance, *times, micro, one.events))
        progress(done, total)
    for done, find in enumerate(cases.values(), len(runs) + 1):
        bounds += [
            Bound(each.case, each.what, each.measured, each.bound, each.unit, each.holds)
            for each in find()
        ]
        progress(done, total)
    return runs, bounds


def _drawings(runs: list[Run]) -> Iterator[Drawing]:
    from gonio.report.dynamics import draw_creep, draw_move, draw_race
    from sim.dynamics.traces import creep_trace, move_trace

    yield draw_race(runs)
    moved, crept = move_trace(), creep_trace()
    yield draw_move(moved.seconds, 1e6 * (moved.load - moved.demand))
    start = crept.demand[0]
    yield draw_creep(crept.seconds, 1e6 * (crept.demand - start), 1e6 * (crept.motor - start))


def _notes() -> list[tuple[str, str]]:
    from sim.dynamics.parameters import AxisParameters

    axis = AxisParameters()
    return [
        ("time constants",
         f"{axis.electrical_s:.0e} s electrical, {axis.mechanical_s:.1g} s mechanical, "
         f"{axis.thermal_s:g} s thermal"),
        ("arm", f"{axis.resonance_hz:.1f} Hz with its motor held"),
        ("times", "of the processor; the first move of the exponential method makes its operators"),
    ]  # fmt: skip
