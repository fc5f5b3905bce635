"""Does the choice of directions matter? Criteria against each other, and against chance.

    python tests/benchmarks/study_designs.py FOLDER [--draws 200] [--only MATERIAL ...]

For each table in FOLDER (npz, 81 x 81): eps8 and male of the estimator `prior` from the 14 x 14
directions of each criterion, chosen before anything of the material is known, and from products
drawn at random. Noise-free values, sigma 0.3 %. Then the means over the materials: of each
criterion, and of the drawn products the mean, the best tenth, and how many beat i-optimal.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import click
import numpy as np

from gonio.materials import MeasuredTable
from gonio.samples import Samples
from nnbrdf.metrics import eps8, male
from nnbrdf.prior import MaterialPrior
from nnbrdf.prior.family import grid_pairs
from nnbrdf.prior.infer import infer
from planner.criteria import CRITERIA, criterion_named
from planner.field import paper_field

SIGMA = 0.003


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--draws", type=int, default=200, help="random products")
    parser.add_argument("--only", nargs="*", help="some of the materials")
    options = parser.parse_args()
    prior, field = MaterialPrior.generate(), paper_field()
    designs = {
        name: criterion_named(name, lambda: prior).product(field, 14, 14).measured
        for name in CRITERIA
        if name != "random"
    }
    drawn = [
        criterion_named("random", seed=seed).product(field, 14, 14).measured
        for seed in range(options.draws)
    ]
    found, chance = [], []
    for path in sorted(options.folder.glob("*.npz")):
        if options.only and path.stem not in options.only:
            continue
        table = MeasuredTable.load(path)
        found.append([errors(prior, table, each) for each in designs.values()])
        chance.append([errors(prior, table, each) for each in drawn])
        echo(path.stem, [*found[-1], *([np.mean(chance[-1], axis=0)] if drawn else [])])
    echo("mean", np.mean(found, axis=0))
    if drawn:
        report(np.mean(chance, axis=0), np.mean(found, axis=0)[list(designs).index("i-optimal")])


def errors(prior: MaterialPrior, table: MeasuredTable, measured: np.ndarray) -> tuple[float, float]:
    rows, grid = np.flatnonzero(measured), grid_pairs()
    value = table.values.reshape(-1, 3)[rows].astype(float)
    samples = Samples.from_values(grid.light[rows], grid.view[rows], value, sigma=SIGMA * value)
    told = infer(prior.families, samples).predict(grid.light, grid.view).median
    told = told.reshape(81, 81, 3)
    return eps8(told, table.values, table.white), male(told, table.values, table.white)


def echo(name: str, pairs: list[tuple[float, float]] | np.ndarray) -> None:
    click.echo(f"{name:32s} " + "  ".join(f"{each[0]:6.2f} / {each[1]:.3f}" for each in pairs))


def report(chance: np.ndarray, chosen: np.ndarray) -> None:
    for column, name in enumerate(("eps8", "male")):
        values = chance[:, column]
        click.echo(
            f"{name}: {len(values)} random products: mean {values.mean():.3f}, best tenth below "
            f"{np.quantile(values, 0.1):.3f}, best {values.min():.3f}; i-optimal "
            f"{chosen[column]:.3f}, beaten by {np.sum(values < chosen[column])}"
        )


if __name__ == "__main__":
    main()
