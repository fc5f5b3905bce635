"""Step sizes at and past the limit of stability, on squared loss; and why absolute loss has none.

On a quadratic of largest curvature s, gradient descent shrinks every error if and only if its
step is below 2 / s. With the running mean m <- b m + (1 - b) g that Adamax steps along, the limit
is (2 + 2 b) / ((1 - b) s): 38 / s for b = 0.9, where s is the largest eigenvalue of the Hessian
divided by Adamax's norm (Cohen et al. 2022, Adaptive gradient methods at the edge of stability).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import torch

from nnbrdf.batched import BETA_1, BETA_2, EPSILON, TORCH_ACTIVATIONS, forward
from nnbrdf.network import glorot_uniform

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Loss = Callable[[torch.Tensor], torch.Tensor]

DESCENT_LIMIT = 2.0
_SMALL = 1e-9
ADAMAX_LIMIT = (2.0 + 2.0 * BETA_1) / (1.0 - BETA_1)


def squared_loss(
    inputs: NDArray[np.float64], targets: NDArray[np.float64], hidden: tuple[int, ...]
) -> tuple[Loss, torch.Tensor]:
    """Return half the mean squared error of a SoftSign network as a function of its weights.

    Parameters
    ----------
    inputs, targets
        Shapes (n, inputs) and (n, outputs).
    hidden
        Outputs of the hidden layers.

    Returns
    -------
    loss, start
        The function, and weights to begin with, shape (weights,), in double precision.
    """
    sizes = (inputs.shape[1], *hidden, targets.shape[1])
    layers = glorot_uniform(sizes, [np.random.default_rng(0)], np.float64).layers
    start = torch.from_numpy(np.concatenate([layer.ravel() for layer in layers]))
    shapes = [layer.shape for layer in layers]
    rows, wanted = torch.from_numpy(inputs)[None], torch.from_numpy(targets)[None]

    def loss(value: torch.Tensor) -> torch.Tensor:
        parts = value.split([int(np.prod(shape)) for shape in shapes])  # type: ignore[no-untyped-call]
        stack = [part.view(shape) for part, shape in zip(parts, shapes, strict=True)]
        residual = forward(stack, rows, TORCH_ACTIVATIONS["softsign"]) - wanted
        return torch.as_tensor(0.5 * residual.square().mean())

    return loss, start


def largest_curvature(
    loss: Loss, at: torch.Tensor, scale: torch.Tensor | None = None, iterations: int = 200
) -> tuple[float, torch.Tensor]:
    """Return the largest eigenvalue of the Hessian and its vector, by power iteration.

    Parameters
    ----------
    loss
        Twice differentiable.
    at
        Weights, shape (weights,).
    scale
        Preconditioner p, shape (weights,): the matrix is then p^-1/2 H p^-1/2.
    iterations
        How often to multiply.
    """
    root = torch.ones_like(at) if scale is None else scale.rsqrt()
    point = at.detach().requires_grad_()
    (gradient,) = torch.autograd.grad(loss(point), point, create_graph=True)
    vector = torch.randn(at.shape, dtype=at.dtype, generator=torch.Generator().manual_seed(0))
    value = 0.0
    for _ in range(iterations):
        vector = vector / vector.norm()
        (product,) = torch.autograd.grad(gradient, point, root * vector, retain_graph=True)
        product = root * product
        value = float(vector @ product)
        vector = product
    return value, vector / vector.norm()


def descend(loss: Loss, start: torch.Tensor, rate: float, steps: int) -> torch.Tensor:
    """Return where plain gradient descent ends."""
    value = start.clone()
    for _ in range(steps):
        value = value - rate * _gradient(loss, value)
    return value


def adamax(
    loss: Loss, start: torch.Tensor, rate: float, steps: int
) -> tuple[torch.Tensor, torch.Tensor]:
    """Return where Adamax on all samples at once ends, and its norm with epsilon there."""
    value, mean, norm = start.clone(), torch.zeros_like(start), torch.zeros_like(start)
    for step in range(1, steps + 1):
        gradient = _gradient(loss, value)
        mean = BETA_1 * mean + (1.0 - BETA_1) * gradient
        norm = torch.maximum(BETA_2 * norm, gradient.abs())
        value = value - rate / (1.0 - BETA_1**step) * mean / (norm + EPSILON)
    return value, norm + EPSILON


def momentum_growth(loss: Loss, start: torch.Tensor, scale: torch.Tensor, rate: float) -> float:
    """Return by what factor Adamax, its norm held fixed, grows an error in 400 steps.

    The error lies along the largest curvature of the preconditioned Hessian; what is measured is
    its part that stays there.
    """
    return _growth(loss, start, scale, rate, BETA_1)


def descent_growth(loss: Loss, start: torch.Tensor, rate: float) -> float:
    """Return by what factor gradient descent grows an error in 400 steps, as `momentum_growth`."""
    return _growth(loss, start, torch.ones_like(start), rate, 0.0)


def _growth(
    loss: Loss, start: torch.Tensor, scale: torch.Tensor, rate: float, beta: float
) -> float:
    base, (_, vector) = _gradient(loss, start), largest_curvature(loss, start, scale)
    moved, mean = _SMALL * vector * scale.rsqrt(), torch.zeros_like(start)
    for _ in range(400):
        # the gradient's change alone: the point itself need not be a minimum
        mean = beta * mean + (1.0 - beta) * (_gradient(loss, start + moved) - base)
        moved = moved - rate * mean / scale
        # other curvatures, negative ones among them, are not what is asked for
        moved = (moved * scale.sqrt() @ vector) * vector * scale.rsqrt()
    return float(moved.norm() / (_SMALL * vector * scale.rsqrt()).norm())


def _gradient(loss: Loss, value: torch.Tensor) -> torch.Tensor:
    point = value.detach().requires_grad_()
    (gradient,) = torch.autograd.grad(loss(point), point)
    return gradient
