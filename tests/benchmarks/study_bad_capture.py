"""What a bad capture costs: estimator `nn` on samples that are wrong in one way each.

    python tests/benchmarks/study_bad_capture.py FOLDER

Means of eps8 / male over the tables in FOLDER (npz, 81 x 81), from 14 x 14 and from 196 free pairs
chosen by i-optimal before anything of the material is known. Otherwise noise-free, sigma 0.3 %; the
same seed for every table.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np
from study_few_shots import choose, errors_of, samples_at

from gonio.directions import normalize
from gonio.materials import MeasuredTable
from gonio.samples import Flag
from nnbrdf.prior import MaterialPrior
from nnbrdf.teaching import TaughtEstimator

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.samples import Samples

    Fault = Callable[[Samples, float, np.random.Generator], Samples]

DESIGNS = ("14 x 14", "196 free")
ROW = "| {:44s} | {:>13s} | {:>13s} |"
NOISE, TOO_BRIGHT, ASTRAY_DEG = 0.05, 1.1, 0.1
GROSS = (10.0, 0.1, 30.0, 5.0, 0.03)
_PARTS = ("light", "view", "value", "sigma", "flag", "light_solid_angle", "view_solid_angle")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    tables = [MeasuredTable.load(path) for path in sorted(parser.parse_args().folder.glob("*.npz"))]
    prior = MaterialPrior.generate()
    designs = choose(prior)
    few = TaughtEstimator(prior=prior)
    click.echo(ROW.format("what", *DESIGNS))
    for name, fault in FAULTS.items():
        cells = []
        for design in DESIGNS:
            errors = [error_of(few, table, designs[design], fault) for table in tables]
            cells.append("{:.2f} / {:.3f}".format(*np.mean(errors, axis=0)))
        click.echo(ROW.format(name, *cells))


def error_of(
    few: TaughtEstimator, table: MeasuredTable, measured: np.ndarray, fault: Fault
) -> tuple[float, float]:
    rng = np.random.default_rng(0)
    spoilt = fault(samples_at(table, measured), table.white, rng)
    return errors_of(few.fit(spoilt).grid()["values"], table)


def nothing(samples: Samples, white: float, rng: np.random.Generator) -> Samples:
    return samples


def gross(samples: Samples, white: float, rng: np.random.Generator) -> Samples:
    value = samples.value.copy()
    value[rng.choice(len(value), len(GROSS), replace=False)] *= np.array(GROSS)[:, None]
    return replace(samples, value=value)


def one_side(samples: Samples, white: float, rng: np.random.Generator) -> Samples:
    factor = np.where(samples.light[:, :1] > 0, TOO_BRIGHT, 1.0)
    return replace(samples, value=samples.value * factor)


def without_a_view(samples: Samples, white: float, rng: np.random.Generator) -> Samples:
    _, which, counts = np.unique(
        samples.view.round(6), axis=0, return_inverse=True, return_counts=True
    )
    kept = which.reshape(-1) != np.argmax(counts)
    rows = {name: getattr(samples, name)[kept] for name in (*_PARTS, "shot_index", "attempt")}
    return replace(samples, **rows)


def clipped(samples: Samples, white: float, rng: np.random.Generator) -> Samples:
    over = samples.value > 2 * white
    flag = np.where(over, samples.flag | np.uint32(Flag.CLIPPED), samples.flag)
    return replace(samples, value=samples.value.clip(max=2 * white), flag=flag)


def noisy(samples: Samples, white: float, rng: np.random.Generator) -> Samples:
    value = samples.value * (1 + NOISE * rng.standard_normal(samples.value.shape))
    return replace(samples, value=value, sigma=NOISE * samples.value)


def astray(samples: Samples, white: float, rng: np.random.Generator) -> Samples:
    """State directions that are off by so much, at any azimuth about the true one."""
    return replace(samples, light=moved(samples.light, rng), view=moved(samples.view, rng))


def moved(direction: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    across = normalize(np.cross(direction, rng.standard_normal(direction.shape)))
    return normalize(direction + np.tan(np.radians(ASTRAY_DEG)) * across)


FAULTS: dict[str, Fault] = {
    "nothing": nothing,
    "five gross errors (x 10, 0.1, 30, 5, 0.03)": gross,
    "lamps of one side 10 % too bright": one_side,
    "the view of most samples missing": without_a_view,
    "clipped at twice white, flagged": clipped,
    "5 % noise": noisy,
    "angles off by 0.1 degrees": astray,
}


if __name__ == "__main__":
    main()
