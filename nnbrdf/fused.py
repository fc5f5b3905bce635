"""Training by the compiled kernel: each network a thread of its own, a step one pass in cache."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadInputError
from nnbrdf.activations import ACTIVATIONS
from nnbrdf.cores import cores
from nnbrdf.network import Networks

try:
    from nnbrdf import _fused
except ImportError:
    _fused = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

MOST_LAYERS = 8


def is_available() -> bool:
    """Tell whether the kernel was compiled when gonio was installed."""
    return _fused is not None


class FusedTrainer:
    """Networks of one shape in training on the same samples, each with its own seed.

    Parameters
    ----------
    networks
        Where to start, float32 or float64, at most 8 layers each.
    inputs, targets
        Shapes (n, inputs) and (n, outputs).
    seeds
        One a member, for the order of its samples and the random slopes of `rrelu`; results do
        not depend on the number of threads.
    rate
        Step size of Adamax.

    Raises
    ------
    gonio.errors.BadInputError
        When the kernel was not compiled, or there are more than 8 layers.
    """

    def __init__(
        self,
        networks: Networks,
        inputs: NDArray[Any],
        targets: NDArray[Any],
        seeds: Sequence[int],
        rate: float,
    ) -> None:
        _check(networks)
        self._activation = networks.activation
        self._inputs, self._targets = inputs, targets
        single = networks.layers[0].dtype == np.float32
        trainer = _fused.Trainer32 if single else _fused.Trainer64
        number = list(ACTIVATIONS).index(networks.activation)
        self._members = [
            trainer(
                [layer[index] for layer in networks.layers], number, inputs, targets, seed, rate
            )
            for index, seed in enumerate(seeds)
        ]
        self._pool = ThreadPoolExecutor(min(cores(), len(self._members)))

    def run(self, steps: int) -> None:
        """Take so many steps more; a member whose gradient overflows stays where it is."""
        if len(self._members) == 1:
            # in the caller's thread, whose time can then be told
            self._members[0].run(steps)
        else:
            list(self._pool.map(lambda member: member.run(steps), self._members))

    def predict(self, inputs: NDArray[Any]) -> NDArray[Any]:
        """Return what the members say now, shape (members, n, outputs)."""
        return np.stack([member.predict(inputs) for member in self._members])

    def networks(self) -> Networks:
        """Return a copy of the members as they are now."""
        layers = zip(*(member.layers for member in self._members), strict=True)
        return Networks(tuple(np.stack(layer) for layer in layers), self._activation)

    @property
    def diverged(self) -> NDArray[np.bool_]:
        """Which members have stopped since their gradient was not finite, shape (members,)."""
        return np.array([member.failed for member in self._members])


def _check(networks: Networks) -> None:
    if not is_available():
        raise BadInputError(
            "the compiled trainer is missing; install a C++ compiler and gonio again, "
            "or use the trainer torch"
        )
    if len(networks.layers) > MOST_LAYERS:
        raise BadInputError(
            f"the network has {len(networks.layers)} layers; the compiled trainer takes "
            f"{MOST_LAYERS}, the trainer torch takes more"
        )
