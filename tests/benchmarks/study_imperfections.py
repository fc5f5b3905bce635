"""What the imperfections of camera and lamps do to samples, one by one and together.

    python tests/benchmarks/study_imperfections.py

The default plan is captured by the ideal twin, and by twins that have one kind of imperfection at
its size in `all`, then all of them as in `mild` and in `all`. Told for each, against the samples of
the ideal twin in percent: the median change of each channel, median and 95 % quantile of the
distance over shots and channels; for some, eps8 and male of what `gonio reconstruct` makes of them.
The second row is the ideal twin with other noise: closer is nothing.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np
import tomli_w
from study_few_shots import errors_of

from gonio.materials import MeasuredTable
from gonio.samples import Samples
from sim.camera_imperfections import ALL, MILD

if TYPE_CHECKING:
    from collections.abc import Sequence

KINDS = {
    "PRNU": ["camera_prnu"],
    "offsets": ["camera_dsnu_e", "camera_column_e"],
    "dark current": ["camera_dark_e_per_s", "camera_sensor_rise_c", "camera_hot_share"],
    "full well": ["camera_full_well"],
    "vignetting": ["camera_cos4", "camera_vignetting"],
    "defocus": ["camera_f_number"],
    "veiling glare": ["camera_glare"],
    "halo": ["camera_halo"],
    "spectral mix": ["lamp_red_per_c", "lamp_blue_per_c"],
}
ROW = "| {:14s} | {:>20s} | {:>6s} | {:>6s} | {:>5s} | {:>5s} |"


def main() -> None:
    sizes = ALL.model_dump()
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        run(root, "plan", "--no-page")
        ideal = captured(root, "ideal")
        click.echo(
            ROW.format("imperfection", "shift of r, g, b, %", "50 %", "95 %", "eps8", "male")
        )
        echo("ideal", ideal, ideal, errors(root, "ideal"))
        other = captured(root, "noise", "--seed", "1")
        echo("other noise", other, ideal, errors(root, "noise"))
        for kind, keys in KINDS.items():
            samples = imperfect(root, kind, {key: sizes[key] for key in keys})
            echo(kind, samples, ideal)
        for name, every in {"mild": MILD, "all": ALL}.items():
            echo(name, imperfect(root, name, every.model_dump()), ideal, errors(root, name))


def run(root: Path, *words: str) -> None:
    subprocess.run(
        [sys.executable, "-m", "gonio", *words], cwd=root, check=True, stdout=subprocess.DEVNULL
    )


def imperfect(root: Path, name: str, sizes: dict[str, float]) -> Samples:
    path = root / "sizes.toml"
    path.write_text(tomli_w.dumps(sizes))
    return captured(root, name, "--imperfections", str(path))


def captured(root: Path, name: str, *options: str) -> Samples:
    run(root, "capture", "--sim", "-o", name, *options)
    run(root, "reduce", name)
    return Samples.load(root / name / "samples.nc")


def errors(root: Path, name: str) -> list[str]:
    run(root, "reconstruct", name)
    truth = MeasuredTable.load(root / name / "sim" / "truth.npz")
    with np.load(root / name / "model" / "grid.npz") as grid:
        eps8, male = errors_of(grid["values"], truth)
    return [f"{eps8:.2f}", f"{male:.3f}"]


def echo(name: str, samples: Samples, ideal: Samples, model: Sequence[str] = ("", "")) -> None:
    away = 100.0 * (samples.value / ideal.value - 1.0)
    shift = ", ".join(f"{channel:+.2f}" for channel in np.median(away, axis=0))
    spread = [f"{np.quantile(np.abs(away), share):.2f}" for share in (0.5, 0.95)]
    click.echo(ROW.format(name, shift, *spread, *model))


if __name__ == "__main__":
    main()
