"""The gradient of stacked networks in closed form, into buffers that are allocated once."""

from __future__ import annotations

from itertools import accumulate

import torch

from nnbrdf.network import Networks


class Parameters:
    """Weights of all members in one vector, their gradient in another, both seen layer by layer.

    Attributes
    ----------
    value, gradient
        Shape (everything,).
    layers, layer_gradients
        Views of the two, shapes (members, outputs, inputs + 1); the last column is the bias.
    """

    def __init__(self, networks: Networks) -> None:
        layers = [torch.from_numpy(layer) for layer in networks.layers]
        self.value = torch.cat([layer.flatten() for layer in layers])
        self.gradient = torch.zeros_like(self.value)
        self.layers = _views(self.value, layers)
        self.layer_gradients = _views(self.gradient, layers)

    def networks(self) -> Networks:
        """Return a copy as it is now."""
        return Networks(tuple(layer.numpy().copy() for layer in self.layers))


class Gradient:
    """Forward and backward pass of one batch size; loss is the mean absolute error.

    A batch lies with its features first, shape (members, features, batch), and ends in a row of
    ones, which the bias column multiplies.

    Parameters
    ----------
    parameters
        Whose gradient is wanted.
    batch
        Number of samples, per member.
    """

    def __init__(self, parameters: Parameters, batch: int) -> None:
        layers = parameters.layers
        self._layers = layers
        self._gradients = parameters.layer_gradients
        self._backward = [layer[:, :, :-1].transpose(1, 2) for layer in layers]
        self._totals = [_buffer(layer, layer.shape[1], batch) for layer in layers]
        self._errors = [torch.empty_like(total) for total in self._totals]
        self._slopes = [torch.empty_like(total) for total in self._totals[:-1]]
        # the row of ones is written here once, and no pass touches it
        self._signals = [_buffer(layer, layer.shape[1] + 1, batch) for layer in layers[:-1]]
        self._outputs = [signal[:, :-1] for signal in self._signals]
        self._scale = 1.0 / (batch * layers[-1].shape[1])

    def compute(self, inputs: torch.Tensor, targets: torch.Tensor) -> None:
        """Fill the parameters' gradient.

        Parameters
        ----------
        inputs
            Shape (members, inputs + 1, batch), its last row ones.
        targets
            Shape (members, outputs, batch).
        """
        signals = [inputs, *self._signals]
        self._forward(signals)
        last = len(self._layers) - 1
        # d|r|/dr is sign(r), and 0 at r = 0
        torch.sign(self._totals[last].sub_(targets), out=self._errors[last])
        self._errors[last].mul_(self._scale)
        for index in range(last, 0, -1):
            self._gradient_of(index, signals[index])
            error = self._errors[index - 1]
            torch.bmm(self._backward[index], self._errors[index], out=error)
            error.mul_(self._slopes[index - 1]).mul_(self._slopes[index - 1])
        self._gradient_of(0, inputs)

    def _forward(self, signals: list[torch.Tensor]) -> None:
        for index, (layer, total) in enumerate(zip(self._layers, self._totals, strict=True)):
            torch.bmm(layer, signals[index], out=total)
            if index < len(self._slopes):
                # softsign is total x slope, and its derivative slope^2
                slope = self._slopes[index]
                torch.abs(total, out=slope).add_(1.0).reciprocal_()
                torch.mul(total, slope, out=self._outputs[index])

    def _gradient_of(self, index: int, signal: torch.Tensor) -> None:
        torch.bmm(self._errors[index], signal.transpose(1, 2), out=self._gradients[index])


def _views(vector: torch.Tensor, like: list[torch.Tensor]) -> list[torch.Tensor]:
    ends = accumulate(layer.numel() for layer in like)
    return [
        vector[end - layer.numel() : end].view(layer.shape)
        for end, layer in zip(ends, like, strict=True)
    ]


def _buffer(layer: torch.Tensor, features: int, batch: int) -> torch.Tensor:
    return torch.ones((layer.shape[0], features, batch), dtype=layer.dtype)
