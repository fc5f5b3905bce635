"""Small fully connected networks, several of one shape stacked; NumPy only."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from nnbrdf.activations import activation_named

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


@dataclass(frozen=True)
class Networks:
    """Members of one shape, evaluated together; the output is linear.

    Attributes
    ----------
    layers
        One array a layer, shape (members, outputs, inputs + 1); the last column is the bias.
    activation
        Of the hidden layers, a name of `nnbrdf.activations.ACTIVATIONS`.

    Raises
    ------
    ValueError
        When a layer's inputs are not the outputs of the one before it.
    gonio.errors.BadInputError
        For an unknown activation.
    """

    layers: tuple[NDArray[Any], ...]
    activation: str = "softsign"

    def __post_init__(self) -> None:
        activation_named(self.activation)
        for layer, next_layer in pairwise(self.layers):
            if next_layer.shape[::2] != (layer.shape[0], layer.shape[1] + 1):
                raise ValueError(
                    f"layers of shapes {layer.shape} and {next_layer.shape} do not fit together"
                )

    @property
    def members(self) -> int:
        """How many networks are stacked."""
        return int(self.layers[0].shape[0])

    @property
    def sizes(self) -> tuple[int, ...]:
        """Number of inputs, then of each layer's outputs."""
        return (self.layers[0].shape[2] - 1, *(layer.shape[1] for layer in self.layers))

    def member(self, index: int) -> Networks:
        """Return one of the networks, as a stack of one."""
        return self.select([index])

    def select(self, indices: Sequence[int]) -> Networks:
        """Return some of the networks, in that order."""
        return Networks(tuple(layer[list(indices)] for layer in self.layers), self.activation)

    def forward(self, inputs: NDArray[Any]) -> NDArray[np.float64]:
        """Return what each member makes of each input.

        Parameters
        ----------
        inputs
            Shape (n, inputs), or (members, n, inputs) where each member has its own.

        Returns
        -------
        ndarray
            Shape (members, n, outputs), in double precision: its round-off hangs on how the
            inputs are split into chunks, and must not show.
        """
        signal = np.swapaxes(np.asarray(inputs, np.float64), -1, -2)
        activate = activation_named(self.activation)
        for index, layer in enumerate(self.layers):
            wide = layer.astype(np.float64)
            total = wide[:, :, :-1] @ signal + wide[:, :, -1:]
            is_output = index == len(self.layers) - 1
            signal = total if is_output else activate(total)
        return np.swapaxes(signal, 1, 2)


def weight_count(sizes: Sequence[int]) -> int:
    """Return how many weights and biases one network has: 1268 for 6-15-30-20-3."""
    return sum((n + 1) * m for n, m in pairwise(sizes))


def glorot_uniform(
    sizes: Sequence[int],
    generators: Sequence[np.random.Generator],
    dtype: type[np.floating[Any]] = np.float32,
    activation: str = "softsign",
) -> Networks:
    """Start one network a generator: weights uniform in +-sqrt(6 / (inputs + outputs)), biases 0.

    Glorot and Bengio (2010), equation 16.
    """
    members = [_glorot_member(sizes, generator, dtype) for generator in generators]
    layers = tuple(np.stack(layer) for layer in zip(*members, strict=True))
    return Networks(layers, activation)


def _glorot_member(
    sizes: Sequence[int], generator: np.random.Generator, dtype: type[np.floating[Any]]
) -> list[NDArray[Any]]:
    layers = []
    for n, m in pairwise(sizes):
        limit = np.sqrt(6.0 / (n + m))
        weights = generator.uniform(-limit, limit, (m, n))
        layers.append(np.concatenate([weights, np.zeros((m, 1))], axis=1).astype(dtype))
    return layers
