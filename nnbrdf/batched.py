"""Training by torch: all networks in one batch of matrices, on a processor or a GPU.

It is the reference of the compiled kernel, and the path where there is no compiler.
"""

from __future__ import annotations

from contextlib import contextmanager
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from torch.nn import functional

from nnbrdf.activations import RRELU_LOWER, RRELU_UPPER, SHRINK
from nnbrdf.network import Networks
from nnbrdf.training import BATCH

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    Activate = Callable[[torch.Tensor], torch.Tensor]

BETA_1, BETA_2, EPSILON = 0.9, 0.999, 1e-7


def mean_rrelu(x: torch.Tensor) -> torch.Tensor:
    """Return rReLU with its mean slope, as away from training."""
    return functional.leaky_relu(x, (RRELU_LOWER + RRELU_UPPER) / 2)


TORCH_ACTIVATIONS: dict[str, Activate] = {
    "linear": lambda x: x,
    "sigmoid": torch.sigmoid,
    "exponential": torch.exp,
    "tanh": torch.tanh,
    "relu": torch.relu,
    "elu": functional.elu,
    "selu": functional.selu,
    # torch's own softplus is cut to x above 20
    "softplus": lambda x: torch.logaddexp(x, torch.zeros_like(x)),
    "tanhshrink": functional.tanhshrink,
    "softsign": functional.softsign,
    "hardshrink": lambda x: functional.hardshrink(x, SHRINK),
    "lisht": lambda x: x * torch.tanh(x),
    "swish": functional.silu,
    "hard-sigmoid": lambda x: torch.clamp(0.2 * x + 0.5, 0.0, 1.0),
    "snake": lambda x: x + torch.sin(x) ** 2,
    "mish": functional.mish,
    "gelu": functional.gelu,
    "softmax": lambda x: torch.softmax(x, dim=-1),
    "rrelu": mean_rrelu,
    "softshrink": lambda x: functional.softshrink(x, SHRINK),
}
"""By the names of `nnbrdf.activations.ACTIVATIONS`, features on the last axis."""


def forward(layers: Sequence[torch.Tensor], inputs: torch.Tensor, activate: Activate) -> Any:
    """Return what stacked networks make of inputs, shape (members, n, outputs).

    Parameters
    ----------
    layers
        Shapes (members, outputs, inputs + 1), the last column the bias.
    inputs
        Shape (members, n, inputs).
    activate
        Of the hidden layers.
    """
    signal = inputs
    for index, layer in enumerate(layers):
        weights = layer[:, :, :-1].transpose(1, 2)
        signal = torch.baddbmm(layer[:, None, :, -1], signal, weights)
        if index < len(layers) - 1:
            signal = activate(signal)
    return signal


class BatchedTrainer:
    """Networks of one shape in training on the same samples, each with its own seed.

    Parameters and meaning are those of `nnbrdf.fused.FusedTrainer`; any number of layers.

    Parameters
    ----------
    device
        A torch device: `cpu`, `cuda`.
    """

    def __init__(
        self,
        networks: Networks,
        inputs: NDArray[Any],
        targets: NDArray[Any],
        seeds: Sequence[int],
        rate: float,
        device: str = "cpu",
    ) -> None:
        dtype = networks.layers[0].dtype
        self._device = torch.device(device)
        self._networks, self._rate = networks, rate
        self._inputs = torch.from_numpy(inputs.astype(dtype)).to(self._device)
        self._targets = torch.from_numpy(targets.astype(dtype)).to(self._device)
        flat = [layer.reshape(networks.members, -1) for layer in networks.layers]
        self._value = torch.from_numpy(np.concatenate(flat, axis=1)).to(self._device)
        self._mean, self._norm = torch.zeros_like(self._value), torch.zeros_like(self._value)
        self._active = torch.ones((networks.members, 1), dtype=torch.bool, device=self._device)
        self._generators = [np.random.default_rng(seed) for seed in seeds]
        self._random = [torch.Generator(self._device).manual_seed(int(each)) for each in seeds]
        self._batches = self._endless_batches()
        self._decay = 1.0

    def run(self, steps: int) -> None:
        """Take so many steps more; a member whose gradient overflows stays where it is."""
        with _one_thread():
            for _ in range(steps):
                self._descend(self._gradient(next(self._batches)))

    def predict(self, inputs: NDArray[Any]) -> NDArray[Any]:
        """Return what the members say now, shape (members, n, outputs)."""
        with torch.inference_mode():
            rows = torch.from_numpy(inputs).to(self._value)
            rows = rows.expand(len(self._value), -1, -1)
            activate = TORCH_ACTIVATIONS[self._networks.activation]
            outputs: NDArray[Any] = forward(self._layers(self._value), rows, activate).cpu().numpy()
            return outputs

    def networks(self) -> Networks:
        """Return a copy of the members as they are now."""
        layers = tuple(layer.cpu().numpy().copy() for layer in self._layers(self._value))
        return Networks(layers, self._networks.activation)

    @property
    def diverged(self) -> NDArray[np.bool_]:
        """Which members have stopped since their gradient was not finite, shape (members,)."""
        stopped: NDArray[np.bool_] = ~self._active[:, 0].cpu().numpy()
        return stopped

    def gradient_size(self) -> NDArray[np.float64]:
        """Return the largest component of each member's gradient over all samples, (members,)."""
        every = torch.arange(len(self._inputs), device=self._device).expand(len(self._value), -1)
        size: NDArray[np.float64] = self._gradient(every).abs().amax(dim=1).cpu().double().numpy()
        return size

    def _layers(self, value: torch.Tensor) -> list[torch.Tensor]:
        like = self._networks.layers
        ends = [0, *accumulate(layer[0].size for layer in like)]
        return [
            value[:, start:end].view(layer.shape)
            for (start, end), layer in zip(pairwise(ends), like, strict=True)
        ]

    def _gradient(self, batch: torch.Tensor) -> torch.Tensor:
        """Return the gradient of each member's mean absolute error, shape (members, weights)."""
        value = self._value.detach().requires_grad_()
        outputs = forward(self._layers(value), self._inputs[batch], self._training_activation())
        loss = (outputs - self._targets[batch]).abs().mean(dim=(1, 2)).sum()
        (gradient,) = torch.autograd.grad(loss, value)
        return gradient

    def _training_activation(self) -> Activate:
        if self._networks.activation != "rrelu":
            return TORCH_ACTIVATIONS[self._networks.activation]
        return self._random_rrelu

    def _random_rrelu(self, x: torch.Tensor) -> torch.Tensor:
        slopes = torch.empty_like(x)
        for of_member, generator in zip(slopes, self._random, strict=True):
            of_member.uniform_(RRELU_LOWER, RRELU_UPPER, generator=generator)
        return torch.where(x < 0, slopes * x, x)

    def _descend(self, gradient: torch.Tensor) -> None:
        """Take one step of Adamax (Kingma and Ba 2015, algorithm 2).

        The epsilon is added to the norm when it divides, as Keras does, whose default 1e-7 it is.
        """
        self._active &= gradient.isfinite().all(dim=1, keepdim=True)
        gradient = torch.where(self._active, gradient, 0.0)
        self._decay *= BETA_1
        self._mean.lerp_(gradient, 1.0 - BETA_1)
        torch.maximum(self._norm.mul_(BETA_2), gradient.abs(), out=self._norm)
        step = self._mean / (self._norm + EPSILON)
        self._value -= torch.where(self._active, step, 0.0) * (self._rate / (1.0 - self._decay))

    def _endless_batches(self) -> Iterator[torch.Tensor]:
        """Yield sample numbers, shape (members, <= 32), each epoch in a new order."""
        count = len(self._inputs)
        while True:
            orders = np.stack([each.permutation(count) for each in self._generators])
            numbers = torch.from_numpy(orders).to(self._device)
            yield from (numbers[:, start : start + BATCH] for start in range(0, count, BATCH))


@contextmanager
def _one_thread() -> Iterator[None]:
    # the matrices are too small to share
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)
