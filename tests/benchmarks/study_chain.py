"""The whole chain on a twin that is less than ideal: what was put in beside what comes out.

    python -m tests.benchmarks.study_chain [none] [mild] [all] [--px 800] [--shots 64] [--keep DIR]

For each set of imperfections, all through the command line: `gonio calibrate`; `gonio geometry`
from 18 views of the board; `gonio color` from four shots of the chart; `gonio capture
--calibration`; `gonio reduce --geometry --color`; `gonio reconstruct`. The arms stand askew as
well (`ASKEW`, in full under `all`, by a tenth under `mild`). Told is each quantity as recovered
and as injected; of the samples the median relative error against the twin's material, how many of
the 90 % intervals hold it, and what the checks flagged.
"""

from __future__ import annotations

import contextlib
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np
import tomli_w

from gonio.checks import Checks
from gonio.materials import MeasuredTable
from gonio.rig import default_rig_text
from gonio.samples import Flag, Samples
from nnbrdf.metrics import eps8, male
from sim.imperfections import load_imperfections
from sim.materials import load_material
from tests.draws import covered, interval_score

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

NAMES = ("none", "mild", "all")
ASKEW = {
    "arm_view_theta_offset_deg": 0.3,
    "arm_view_phi_offset_deg": -0.4,
    "arm_view_phi_tilt_x_deg": 0.2,
    "arm_view_phi_tilt_y_deg": -0.15,
    "arm_view_theta_tilt_deg": 0.1,
    "arm_view_roll_deg": 0.25,
    "arm_view_distance_mm": 3.0,
    "arm_view_centre_x_mm": 0.5,
    "arm_view_centre_y_mm": -0.4,
    "arm_view_centre_z_mm": 0.3,
    "arm_light_theta_offset_deg": 0.02,
    "arm_light_phi_offset_deg": -0.02,
}
"""What no named set holds; nothing corrects the light arm's, so they are as small as is stated."""

SHARE = {"none": 0.0, "mild": 0.1, "all": 1.0}
ANGLE_DEG = {"none": 0.005, "mild": 0.01, "all": 0.035}
"""What a rig file should state: zeros of the light arm, and how far arms bend behind encoders."""
VIEWS = "rings:0x1,20x5,40x6,60x6"
CHART = (
    "--view-candidates", "rings:0x1", "--light-candidates", "rings:45x4", "--density", "all",
    "--no-page",
)  # fmt: skip
"""Lamps that are warm are of another color than the camera's matrix was made for."""
# a camera of the built-in one's focal length in pixels sees 2 px/mm; at 8 px/mm the board is read
FOCAL_PER_PX = 16_000.0 / 1100

Table = dict[str, tuple[str, str]]
"""By quantity, what was recovered and what injected."""


@click.command()
@click.argument("names", nargs=-1, type=click.Choice(NAMES))
@click.option("--px", default=800, show_default=True, help="Along a side of the sensor.")
@click.option("--shots", default=64, show_default=True)
@click.option("--material", default="wood-veneer", show_default=True)
@click.option("--keep", type=click.Path(path_type=Path), help="Folder to leave everything in.")
def main(names: tuple[str, ...], px: int, shots: int, material: str, keep: Path | None) -> None:
    """Go through the chain and tell how it went."""
    found = {}
    for name in names or NAMES:
        with folder_for(keep, name) as root:
            rig = rig_text(px, angle_deg=ANGLE_DEG[name])
            found[name] = chain(root, name, rig, shots=shots, material=material)
        tell(found)


@contextlib.contextmanager
def folder_for(keep: Path | None, name: str) -> Iterator[Path]:
    if keep is None:
        with tempfile.TemporaryDirectory() as folder:
            yield Path(folder)
        return
    (keep / name).mkdir(parents=True)
    yield keep / name


def rig_text(px: int, exposures_s: Sequence[float] = (0.07, 0.7), angle_deg: float = 0.02) -> str:
    """Return the built-in rig's file with a sensor that sees the whole board."""
    stated = f"\n[uncertainty]\nangle_deg = {angle_deg}\nlamp_color = 0.3\n"
    return _rig_text(px, exposures_s) + stated


def _rig_text(px: int, exposures_s: Sequence[float]) -> str:
    return (
        default_rig_text()
        .replace("= 160", f"= {px}")
        .replace("[79.5, 79.5]", f"[{(px - 1) / 2}, {(px - 1) / 2}]")
        .replace("focal_px = 4000.0", f"focal_px = {FOCAL_PER_PX * px:.1f}")
        .replace("[0.002, 0.02, 0.2, 2.0]", str(list(exposures_s)))
        # white frames and shots in lamps of one color
        .replace("[lamps]\n", "[lamps]\nwarm_up_s = 100.0\n")
    )


def chain(
    root: Path, name: str, rig: str, *, shots: int, material: str, views: str = VIEWS
) -> Table:
    """Run every command in a folder; return what came out beside what was put in."""
    sizes = load_imperfections(name).model_dump()
    sizes |= {key: SHARE[name] * value for key, value in ASKEW.items()}
    (root / "rig.toml").write_text(rig)
    (root / "sizes.toml").write_text(tomli_w.dumps(sizes))
    on_twin = ("--sim", "--rig", "rig.toml", "--imperfections", "sizes.toml")
    rows = printed(run(root, "calibrate", *on_twin), recovered=1, injected=2)
    which = ("--view-candidates", views, "--views", "all", "--lights", "1", "--no-page")
    run(root, "plan", "--rig", "rig.toml", *which, "-o", "views.json")
    run(root, "capture", *on_twin, "--material", "charuco", "--plan", "views.json", "-o", "board")
    rows |= printed(run(root, "geometry", "board"), recovered=1, injected=3)
    run(root, "plan", "--rig", "rig.toml", *CHART, "-o", "chart.json")
    with_sensor = ("--calibration", "calibration")
    of_chart = ("--material", "colorchecker", "--plan", "chart.json", "-o", "chart")
    run(root, "capture", *on_twin, *of_chart, *with_sensor)
    run(root, "color", "chart", "-o", "color.json")
    spread = ("--shots", str(shots), "--anchors", "20", "--no-page")
    run(root, "plan", "--rig", "rig.toml", *spread, "-o", "plan.json")
    of_sample = ("--material", material, "--plan", "plan.json", "-o", "session")
    run(root, "capture", *on_twin, *of_sample, *with_sensor)
    run(root, "reduce", "session", "--geometry", "geometry.json", "--color", "color.json")
    run(root, "reconstruct", "session")
    return rows | of_samples(root / "session", material) | of_model(root / "session")


def run(root: Path, *words: str) -> str:
    click.echo(f"gonio {' '.join(words)}", err=True)
    done = subprocess.run(
        [sys.executable, "-m", "gonio", *words],
        cwd=root, env=os.environ | {"COLUMNS": "200"}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode:
        raise click.ClickException(f"gonio {words[0]}: {done.stderr}")
    return done.stdout


def printed(text: str, *, recovered: int, injected: int) -> Table:
    """Return a printed table's rows by their first column."""
    rows = [re.split(r"\s{2,}", line.strip()) for line in text.splitlines()]
    return {
        row[0]: (row[recovered], row[injected])
        for row in rows
        if len(row) > injected and row[0] not in ("quantity", "found")
    }


def of_samples(session: Path, material: str) -> Table:
    samples = Samples.load(session / "samples.nc")
    truth = load_material(material).evaluate(samples.light, samples.view)
    usable = samples.flag & (Flag.CLIPPED | Flag.SUSPECT) == 0
    value, sigma, true = samples.value[usable], samples.sigma[usable], truth[usable]
    off = value / true - 1.0
    shift = [np.median((samples.value / truth - 1.0)[:, c][usable[:, c]]) for c in range(3)]
    failing = [check.name for check in Checks.load(session / "checks.json").checks if not check.ok]
    told = {
        "samples": f"{len(samples)}",
        "median relative error": f"{100 * np.median(np.abs(off)):.2f} %",
        "95 % quantile of it": f"{100 * np.quantile(np.abs(off), 0.95):.2f} %",
        "median shift of r, g, b": ", ".join(f"{100 * each:+.2f} %" for each in shift),
        "median sigma": f"{100 * np.median(sigma / true):.2f} %",
        "coverage of 90 % intervals": f"{100 * covered(value, sigma, true):.1f} %",
        "interval score": f"{interval_score(value, sigma, true):.4f}",
        "checks that flag": ", ".join(failing) or "none",
    }
    injected = {"coverage of 90 % intervals": "90 %"}
    return {quantity: (each, injected.get(quantity, "")) for quantity, each in told.items()}


def of_model(session: Path) -> Table:
    truth = MeasuredTable.load(session / "sim" / "truth.npz")
    with np.load(session / "model" / "grid.npz") as grid:
        values, low, high = (grid[key].astype(float) for key in ("values", "lo", "hi"))
    held = float(np.mean((low <= truth.values) & (truth.values <= high)))
    return {
        "eps8 of the model": (f"{eps8(values, truth.values, truth.white):.2f}", "0"),
        "male of the model": (f"{male(values, truth.values, truth.white):.3f}", "0"),
        "coverage of the model's band": (f"{100 * held:.1f} %", "90 %"),
    }


def tell(found: dict[str, Table]) -> None:
    heads = [head for name in found for head in (f"`{name}`", "injected")]
    click.echo(" | ".join(["| quantity", *heads]) + " |")
    click.echo("| --- " * (1 + len(heads)) + "|")
    for quantity in dict.fromkeys(key for table in found.values() for key in table):
        cells = [cell for table in found.values() for cell in table.get(quantity, ("", ""))]
        click.echo(" | ".join([f"| {quantity}", *cells]) + " |")


if __name__ == "__main__":
    main()
