"""What the rig costs: raw frames of the noisy twin against noise-free values of the same pairs.

    python tests/benchmarks/study_twin.py FOLDER

For each table in FOLDER (npz, 81 x 81): eps8 / male of estimator `nn` from the values of the table
at the pairs of the default plan, and of `gonio plan; gonio capture --sim; gonio reconstruct`, with
the ratio in eps8; then their means and the ratio of these.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import click
import numpy as np
from study_few_shots import errors_of, ratio, samples_at

from gonio.materials import MeasuredTable
from gonio.plan import Plan
from nnbrdf.prior import MaterialPrior
from nnbrdf.teaching import TaughtEstimator
from planner.candidates import paper_candidates
from planner.locate import rows_of

ROW = "| {:32s} | {:>13s} | {:>13s} | {:>5s} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder.resolve()
    few = TaughtEstimator(prior=MaterialPrior.generate())
    click.echo(ROW.format("material", "noise-free", "from frames", "ratio"))
    found = []
    for path in sorted(folder.glob("*.npz")):
        table = MeasuredTable.load(path)
        values, plan = through_the_twin(path)
        clean = few.fit(samples_at(table, pairs_of(plan))).grid()["values"]
        found.append((errors_of(clean, table), errors_of(values, table)))
        echo(path.stem, *found[-1])
    echo("mean", *np.mean(found, axis=0))


def through_the_twin(material: Path) -> tuple[np.ndarray, Plan]:
    with tempfile.TemporaryDirectory() as folder:
        run(folder, "plan", "--no-page")
        run(folder, "capture", "--sim", "--material", str(material))
        run(folder, "reconstruct", "session/")
        with np.load(Path(folder) / "session" / "model" / "grid.npz") as grid:
            return grid["values"], Plan.load(Path(folder) / "plan.json")


def run(folder: str, *words: str) -> None:
    subprocess.run(
        [sys.executable, "-m", "gonio", *words], cwd=folder, check=True, stdout=subprocess.DEVNULL
    )


def pairs_of(plan: Plan) -> np.ndarray:
    grid = paper_candidates()
    measured = np.zeros((len(grid), len(grid)), bool)
    measured[rows_of(plan, "light", grid), rows_of(plan, "view", grid)] = True
    return measured


def echo(name: str, clean: tuple[float, float], twin: tuple[float, float]) -> None:
    cells = ["{:.2f} / {:.3f}".format(*each) for each in (clean, twin)]
    click.echo(ROW.format(name, *cells, ratio(twin, clean)))


if __name__ == "__main__":
    main()
