"""Absolute loss has no limit of stability: the step sets where the loss comes to rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.network import glorot_uniform
from nnbrdf.training import losses, make_trainer

if TYPE_CHECKING:
    from numpy.typing import NDArray

SEEDS = 5


def loss_floor(
    inputs: NDArray[np.float64], targets: NDArray[np.float64], rate: float, steps: int
) -> float:
    """Return the median final loss of five SoftSign networks 15-30-20 for a step size.

    Parameters
    ----------
    inputs, targets
        Shapes (n, inputs) and (n, outputs).
    rate
        Step size of Adamax.
    steps
        How long to train.
    """
    sizes = (inputs.shape[1], 15, 30, 20, targets.shape[1])
    networks = glorot_uniform(sizes, [np.random.default_rng(seed) for seed in range(SEEDS)])
    running = make_trainer(networks, inputs, targets, range(SEEDS), rate=rate)
    running.run(steps)
    return float(np.median(losses(running.predict(inputs), targets)))
