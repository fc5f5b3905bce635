"""What leaving out saves, and what it costs: estimator `nn` as it is, and with `--general`.

    python tests/benchmarks/study_left_out.py FOLDER

For each table in FOLDER (npz, 81 x 81), from 196 free pairs chosen by i-optimal: weights, seconds
of the fit, milliseconds of a million pairs, and eps8 / male, of both; then their means. Noise-free
values, sigma 0.3 %.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import click
import numpy as np

from gonio.materials import MeasuredTable
from gonio.samples import Samples
from nnbrdf.compare import Trial, competitors
from nnbrdf.compared import DEFAULT, GENERAL
from nnbrdf.prior import MaterialPrior
from nnbrdf.prior.family import grid_pairs
from planner.field import paper_field
from planner.optimal import IOptimal

SHOTS, SIGMA = 196, 0.003
ROW = "| {:30s} | {:>12s} | {:>11s} | {:>11s} | {:>27s} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    prior = MaterialPrior.generate()
    estimators = [competitors(prior)[name] for name in (DEFAULT, GENERAL)]
    rows = np.flatnonzero(IOptimal(lambda: prior).pairs(paper_field(), SHOTS).measured)
    click.echo(ROW.format("material", "weights", "fit (s)", "eval. (ms)", "eps8 / male"))
    found = []
    for path in sorted(folder.glob("*.npz")):
        table = MeasuredTable.load(path)
        grid, value = grid_pairs(), table.values.reshape(-1, 3)[rows]
        samples = Samples.from_values(grid.light[rows], grid.view[rows], value, sigma=SIGMA * value)
        trial = Trial.of(samples, table)
        entries = [trial.enter("", each) for each in estimators]
        found.append(
            [(e.weights, e.fit_seconds, 1000 * e.million_seconds, e.eps8, e.male) for e in entries]
        )
        echo(path.stem, found[-1])
    echo("mean", np.mean(found, axis=0))


def echo(name: str, both: object) -> None:
    weights, fit, million, eps8, male = np.array(both, float).T
    click.echo(
        ROW.format(
            name,
            "{:.0f}, {:.0f}".format(*weights),
            "{:.1f}, {:.1f}".format(*fit),
            "{:.0f}, {:.0f}".format(*million),
            f"{eps8[0]:.2f} / {male[0]:.3f}, {eps8[1]:.2f} / {male[1]:.3f}",
        )
    )


if __name__ == "__main__":
    main()
