"""Does the 5 to 95 % band hold nine of ten? Over many materials that the prior has not seen.

    python tests/benchmarks/study_calibration.py --draws 1000 --shots 64

Each draw is a generated material of a seed outside the prior's, isotropic or not, measured at
random pairs with 1 % noise and reconstructed; one random pair elsewhere is scored, so that draws
are independent. Prints coverage with its standard error, and the interval
score (Gneiting and Raftery 2007, equation 43) of the logarithm over that of a constant relative
sigma, the best there is for all draws together.
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

import click
import numpy as np
from rich.progress import track

from gonio.directions import from_degrees
from gonio.samples import Samples
from nnbrdf.estimators import estimator_named
from nnbrdf.prior import MaterialPrior, Pairs
from nnbrdf.prior.generated import GeneratedMaterials

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

ALPHA = 0.1
Z95 = 1.6448536269514722
NOISE = 0.01
OFFSET = 0.01


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=1000)
    parser.add_argument("--shots", type=int, default=64)
    parser.add_argument("--estimator", choices=["prior", "nn"], default="prior")
    options = parser.parse_args()
    estimator = estimator_named(options.estimator)(prior=MaterialPrior.generate())
    draws = track(range(options.draws), description="materials")
    told = np.array([draw(estimator, seed, options.shots) for seed in draws])
    low, middle, high, true = told.T
    held = (low <= true) & (true <= high)
    spread = np.sqrt(held.mean() * (1 - held.mean()) / len(held))
    click.echo(
        f"{len(held)} draws, {options.shots} shots: coverage {held.mean():.3f} +- {spread:.3f}"
    )
    mine = interval_score(low, high, true)
    constant = min(
        interval_score(middle - Z95 * sigma, middle + Z95 * sigma, true)
        for sigma in np.geomspace(0.003, 3, 60)
    )
    click.echo(
        f"interval score {mine:.3f}, constant relative sigma {constant:.3f} (lower is better)"
    )


def draw(estimator: Any, seed: int, shots: int) -> tuple[float, float, float, float]:
    """Return the band's ends, the median and the truth at one pair, as logarithms."""
    rng = np.random.default_rng([seed, 77])
    material = GeneratedMaterials.draw(1, 10_000 + seed, isotropic=bool(rng.random() < 0.5))
    light, view = directions(rng, shots), directions(rng, shots)
    value = np.repeat(material.evaluate(Pairs.of(light, view)), 3, axis=1)
    value *= 1 + NOISE * rng.standard_normal(value.shape)
    model = estimator.fit(Samples.from_values(light, view, value, sigma=NOISE * np.abs(value)))
    light, view = directions(rng, 1), directions(rng, 1)
    low, high = model.quantiles(light, view)
    true = material.evaluate(Pairs.of(light, view))[0, 0]
    floor = OFFSET * model.card.scale
    ends = (low[0, 0], model.evaluate(light, view)[0, 0], high[0, 0], true)
    first, second, third, last = np.log(np.array(ends) + floor).tolist()
    return first, second, third, last


def directions(rng: np.random.Generator, count: int) -> Array:
    return from_degrees(rng.uniform(0, 75, count), rng.uniform(0, 360, count))


def interval_score(low: Array, high: Array, true: Array) -> float:
    below, above = (low - true).clip(0.0), (true - high).clip(0.0)
    return float((high - low + 2 / ALPHA * (below + above)).mean())


if __name__ == "__main__":
    main()
