"""`gonio calibrate`: measure what the camera does to light."""

from __future__ import annotations

import shlex
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._imperfections import imperfections_option
from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rich.table import Table

    from gonio.calibrate.findings import Findings
    from gonio.calibration import CalibrationDocument, TwinIdentity
    from gonio.capture import Instrument, Operator
    from gonio.cli._injected import Row
    from gonio.rig import Rig


_FAR_ENOUGH = 0.7


@click.command(name="calibrate")
@click.option("--sim", is_flag=True, help="Use the simulated twin of the rig, on a virtual clock.")
@click.option(
    "--rig", "rig_path", type=click.Path(path_type=Path), help="A rig file.  [default: built in]"
)
@click.option(
    "--seed", type=click.IntRange(min=0), help="With --sim, which sensor it is.  [default: 0]"
)
@imperfections_option
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default=Path("calibration"),
    show_default=True,
    help="The calibration's folder; an existing one is never overwritten.",
)
@answers
def command(
    *,
    sim: bool,
    rig_path: Path | None,
    seed: int | None,
    imperfections: str | None,
    output: Path,
) -> None:
    """Measure the camera: dark current, gain, noise, linearity, flat field, bad pixels, lamps.

    Lay the white reference in the holder. Dark frames are taken, then the reference at 45:0 at many
    levels, with the camera turned about its axis, and under each lamp alone. What was found is in
    calibration.html. gonio capture --calibration measures with it.

    \b
    Examples:
        gonio calibrate --sim --imperfections mild
        gonio calibrate --rig rig.toml -o calibration-may/
    """  # noqa: D301
    from gonio.cli._console import console, note
    from gonio.errors import BadInputError
    from gonio.report.calibration_page import PAGE_NAME
    from gonio.rig import default_rig, load_rig

    if not (sim or rig_path):
        raise BadInputError(
            "which rig? give its file with --rig, or add --sim to calibrate the simulated one"
        )
    for name, value in (("--seed", seed), ("--imperfections", imperfections)):
        if value is not None and not sim:
            raise BadInputError(f"{name} is an option of --sim; add that, or leave it out")
    rig = load_rig(rig_path) if rig_path else default_rig()
    twin = (seed or 0, imperfections or "none") if sim else None
    document = _calibrated(rig, twin, output)
    console.print(f"wrote {output}, sha256 {document.sha256}; look at {output / PAGE_NAME}")
    for said in notes_of(document):
        note(said)
    same = {"--rig": rig_path, "--seed": seed, "--imperfections": imperfections}
    console.print(f"next: {_next(same, output, sim=sim)}", markup=False)
    found = document.model_dump(mode="json", exclude={"schema_"})
    answer({"folder": output, "sha256": document.sha256, **found})


def _next(options: Mapping[str, object], output: Path, *, sim: bool) -> str:
    """Return the command that measures with the calibration, on the same rig or twin."""
    given = [str(word) for pair in options.items() if pair[1] is not None for word in pair]
    return shlex.join(["gonio", "capture", *["--sim"] * sim, *given, "--calibration", str(output)])


def _calibrated(rig: Rig, twin: tuple[int, str] | None, output: Path) -> CalibrationDocument:
    """Take and evaluate everything aside, then put it in place, whole or not at all."""
    from gonio.calibrate import calibrate_rig
    from gonio.calibrate.record import document_of, seal, write_maps
    from gonio.calibration import MAPS_NAME
    from gonio.cli._console import console, progress_bar
    from gonio.newfolder import new_folder
    from gonio.report.calibration_page import write_calibration_page

    with new_folder(output, "name another folder with -o") as folder:
        frames = folder / "frames"
        frames.mkdir()
        with (
            _driven(rig, twin) as (instrument, operator, identity),
            progress_bar("calibrating") as progress,
        ):
            findings = calibrate_rig(instrument, operator, rig, frames, progress)
            made_utc = instrument.clock.utc()
        write_maps(findings, folder)
        document = document_of(findings, made_utc, identity)
        compared = _compared(findings, twin)
        write_calibration_page(folder, document, folder / MAPS_NAME, compared)
        console.print(_table(document, compared))
        return seal(document, folder)


def notes_of(document: CalibrationDocument) -> Iterator[str]:
    """Yield what the exposures of the rig file left open."""
    free = [point.signal for point in document.transfer if not point.saturated]
    brightest = max(free) / document.linearity.raw_range
    remedy = "add a longer exposure to camera.exposures_s"
    if brightest < _FAR_ENOUGH:
        yield (
            f"the white reference fills {100 * brightest:.0f} % of the range "
            f"at most, and linearity is known little further; {remedy}"
        )
    if not document.end_seen:
        yield (
            "no exposure overexposes the white reference, so raw values are taken to end at "
            f"WhiteLevel, where a sensor may end before; {remedy}"
        )


@contextmanager
def _driven(
    rig: Rig, twin: tuple[int, str] | None
) -> Iterator[tuple[Instrument, Operator, TwinIdentity | None]]:
    """Connect to the rig or to its twin; yields which simulated camera it has as well."""
    if twin is None:
        from gonio.capture.hardware import hardware

        with hardware(rig) as (instrument, operator):
            yield instrument, operator, None
        return
    from gonio.api.twin import simulated_rig, twin_identity
    from sim.imperfections import load_imperfections

    seed, wanted = twin[0], load_imperfections(twin[1])
    with simulated_rig(rig, seed, wanted) as (simulated, changer, _):
        yield simulated, changer, twin_identity(seed, wanted)


def _compared(findings: Findings, twin: tuple[int, str] | None) -> list[Row]:
    """Return what was found beside what was injected, where that is known."""
    if twin is None:
        return []
    from gonio.cli._injected import against_injected
    from sim.imperfections import load_imperfections

    return against_injected(findings, twin[0], load_imperfections(twin[1]).of_camera)


def _table(document: CalibrationDocument, compared: list[Row]) -> Table:
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    for name in ("quantity", "recovered", *(["injected"] if compared else [])):
        table.add_column(name)
    for row in compared or _found(document):
        table.add_row(*row)
    return table


def _found(document: CalibrationDocument) -> list[tuple[str, str]]:
    seen = document.stray_light
    return [
        ("gain, raw/e", f"{document.gain:.4f} +- {document.gain_sigma:.4f}"),
        ("read noise, e", f"{document.read_noise_e:.3f}"),
        ("full well, e", f"{document.full_well_e:.0f}"),
        ("nonlinearity", f"{100 * document.linearity.deviation:.2f} %"),
        ("stray light", f"{100 * seen.share:.2f} %" if seen else "not seen"),
        ("bad pixels", str(sum(count for _, count in document.bad_pixels))),
    ]
