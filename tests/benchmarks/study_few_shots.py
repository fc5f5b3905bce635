"""Few shots against all of them, on measured materials.

    python tests/benchmarks/study_few_shots.py FOLDER

For each table in FOLDER (npz, 81 x 81): eps8 / male of the paper's network trained on all
6561 pairs (five seeds, median), and of estimator `nn` at 196 free pairs, 14 x 14 and 64 free pairs,
all chosen by i-optimal before anything of the material is known; then how many times the network's
error, the floor that no reciprocal model passes, how many times that floor, and how much of the
truth the 5 to 95 % bands of the three hold. Noise-free values, sigma 0.3 %.
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from gonio.materials import MeasuredTable
from gonio.samples import Samples
from nnbrdf.ensemble import Ensemble
from nnbrdf.metrics import eps8, male
from nnbrdf.paper import PaperEstimator
from nnbrdf.prior import MaterialPrior
from nnbrdf.prior.family import grid_pairs
from nnbrdf.teaching import TaughtEstimator
from planner.field import paper_field
from planner.optimal import IOptimal

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nnbrdf.model import NNBRDF

SIGMA = 0.003
ROW = "| {:32s} | {:>13s} | {:>13s} | {:>13s} | {:>13s} | {:>11s} | {:>13s} | {:>11s} | {:>10s} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--size", help="of the network, by weights")
    options = parser.parse_args()
    prior = MaterialPrior.generate()
    designs = choose(prior)
    few = TaughtEstimator(prior=prior, size=options.size)
    head = ("material", "all, paper", *designs, "196 / paper", "floor", "196 / floor", "held (%)")
    click.echo(ROW.format(*head))
    rows, bands = [], []
    for path in sorted(options.folder.glob("*.npz")):
        table = MeasuredTable.load(path)
        errors = [paper_error(table)]
        grids = [few.fit(samples_at(table, each)).grid() for each in designs.values()]
        errors += [errors_of(grid["values"], table) for grid in grids]
        errors.append(errors_of(floor(table), table))
        rows.append(errors)
        bands.append([held(grid, table) for grid in grids])
        echo(path.stem, errors, bands[-1])
    for name, statistic in (("mean", np.mean), ("median", np.median)):
        columns = [tuple(statistic(column, axis=0)) for column in zip(*rows, strict=True)]
        echo(name, columns, statistic(bands, axis=0))


def choose(prior: MaterialPrior) -> dict[str, np.ndarray]:
    criterion, field = IOptimal(lambda: prior), paper_field()
    return {
        "196 free": criterion.pairs(field, 196).measured,
        "14 x 14": criterion.product(field, 14, 14).measured,
        "64 free": criterion.pairs(field, 64).measured,
    }


def samples_at(table: MeasuredTable, measured: np.ndarray) -> Samples:
    rows = np.flatnonzero(measured)
    grid, value = grid_pairs(), table.values.reshape(-1, 3)[rows].astype(float)
    return Samples.from_values(grid.light[rows], grid.view[rows], value, sigma=SIGMA * value)


def held(grid: dict[str, np.ndarray], table: MeasuredTable) -> float:
    return float(np.mean((grid["lo"] <= table.values) & (table.values <= grid["hi"])))


def paper_error(table: MeasuredTable) -> tuple[float, float]:
    model: NNBRDF = PaperEstimator().fit(samples_at(table, np.ones((81, 81), bool)))
    grid = grid_pairs()
    ensemble = Ensemble(model.networks, model.card.encoding, model.card.white)
    told = ensemble.predict(grid.light, grid.view).clip(0.0).reshape(-1, 81, 81, 3)
    median = partial(np.median, axis=0)
    return tuple(median([errors_of(member, table) for member in told]).tolist())


def floor(table: MeasuredTable) -> np.ndarray:
    log = np.log(table.values + 0.01 * table.white)
    return np.exp(0.5 * (log + np.swapaxes(log, 0, 1))) - 0.01 * table.white


def errors_of(values: np.ndarray, table: MeasuredTable) -> tuple[float, float]:
    pair = (table.values, table.white)
    return eps8(values.astype(float), *pair), male(values.astype(float), *pair)


def echo(name: str, errors: list[tuple[float, float]], bands: Sequence[float]) -> None:
    cells = [f"{e:.2f} / {m:.3f}" for e, m in errors]
    of_paper, of_floor = (ratio(errors[1], errors[each]) for each in (0, 4))
    percents = ", ".join(f"{100 * share:.0f}" for share in bands)
    click.echo(ROW.format(name, *cells[:4], of_paper, cells[4], of_floor, percents))


def ratio(error: tuple[float, float], other: tuple[float, float]) -> str:
    # a table that is reciprocal but for round-off has a floor of all but 0
    return f"{error[0] / other[0]:.2f}" if other[0] >= 0.005 else "-"


if __name__ == "__main__":
    main()
