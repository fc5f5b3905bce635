"""Single against double precision over a whole training."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.network import Networks, glorot_uniform
from nnbrdf.training import checkpoint_steps, losses, make_trainer

if TYPE_CHECKING:
    from numpy.typing import NDArray

SEEDS = 20


@dataclass(frozen=True)
class Drift:
    """Twenty trainings in both precisions, from one start and in one order each.

    Attributes
    ----------
    steps
        Where they were held against each other.
    apart
        Median over the seeds of the mean absolute difference of what the two say, in units of
        white, at each of the steps.
    losses
        Final mean absolute error in single and double precision, shape (2, seeds).
    """

    steps: list[int]
    apart: list[float]
    losses: NDArray[np.float64]


def drift(
    activation: str, inputs: NDArray[np.float64], targets: NDArray[np.float64], steps: int
) -> Drift:
    """Train the paper's network in both precisions side by side.

    Parameters
    ----------
    inputs, targets
        Shapes (n, inputs) and (n, outputs).
    steps
        How long.
    """
    generators = [np.random.default_rng(seed) for seed in range(SEEDS)]
    sizes = (inputs.shape[1], 15, 30, 20, targets.shape[1])
    start = glorot_uniform(sizes, generators, np.float32, activation)
    double = Networks(tuple(layer.astype(np.float64) for layer in start.layers), activation)
    both = [make_trainer(each, inputs, targets, range(SEEDS)) for each in (start, double)]
    stops, apart, done = checkpoint_steps(steps), [], 0
    for stop in stops:
        for each in both:
            each.run(stop - done)
        done = stop
        said = [each.predict(inputs) for each in both]
        apart.append(float(np.median(losses(*said))))
    return Drift(stops, apart, np.stack([losses(each, targets) for each in said]))
