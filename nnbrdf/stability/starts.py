"""How a training begins, and which units end up dead."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.activations import activation_named
from nnbrdf.batched import BatchedTrainer
from nnbrdf.network import glorot_uniform
from nnbrdf.training import RATE, losses, make_trainer

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nnbrdf.network import Networks

SEEDS = 20
_SAME = 1e-6


@dataclass(frozen=True)
class Start:
    """Over twenty seeds of one activation.

    Attributes
    ----------
    output
        Median of the largest output before training, in units of white.
    gradient, largest_gradient
        Median and largest of the largest component of the first gradient.
    idle
        How many end no better than the best constant.
    diverged
        How many stopped.
    dead
        Share of hidden units that say the same to every sample at the end.
    """

    output: float
    gradient: float
    largest_gradient: float
    idle: int
    diverged: int
    dead: float


def look_at_start(
    activation: str,
    inputs: NDArray[np.float64],
    targets: NDArray[np.float64],
    hidden: tuple[int, ...],
    steps: int,
) -> Start:
    """Train twenty networks, and tell how they began and ended.

    Parameters
    ----------
    inputs, targets
        Shapes (n, inputs) and (n, outputs).
    hidden
        Outputs of the hidden layers.
    steps
        How long to train.
    """
    generators = [np.random.default_rng(seed) for seed in range(SEEDS)]
    sizes = (inputs.shape[1], *hidden, targets.shape[1])
    networks = glorot_uniform(sizes, generators, np.float64, activation)
    with np.errstate(over="ignore", invalid="ignore"):
        outputs = np.abs(networks.forward(inputs)).max(axis=(1, 2))
    # torch's path shows the gradients of all networks at once
    gradients = BatchedTrainer(networks, inputs, targets, range(SEEDS), RATE).gradient_size()
    running = make_trainer(networks, inputs, targets, range(SEEDS))
    running.run(steps)
    last = losses(running.predict(inputs), targets)
    constant = np.abs(targets - np.median(targets, axis=0)).mean()
    return Start(
        float(np.median(outputs)),
        float(np.median(gradients)),
        float(gradients.max()),
        int((~running.diverged & ~(last < constant)).sum()),
        int(running.diverged.sum()),
        dead_share(running.networks(), inputs),
    )


def dead_share(networks: Networks, inputs: NDArray[np.float64]) -> float:
    """Return the share of hidden units whose output does not change over the inputs."""
    activate = activation_named(networks.activation)
    signal, dead, units = np.asarray(inputs, np.float64).T[None], 0, 0
    for layer in networks.layers[:-1]:
        with np.errstate(over="ignore", invalid="ignore"):
            signal = activate(layer[:, :, :-1] @ signal + layer[:, :, -1:])
            spread = np.ptp(signal, axis=2)
        dead += int((spread < _SAME).sum())
        units += spread.size
    return dead / units
