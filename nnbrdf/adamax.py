"""Adamax, fused over one vector of parameters."""

from __future__ import annotations

import torch

RATE = 0.0025
_BETA_1, _BETA_2 = 0.9, 0.999
_EPSILON = 1e-7


class Adamax:
    """Adam on the infinity norm (Kingma and Ba 2015, algorithm 2).

    The epsilon is added to the norm when it divides, as Keras does, whose default 1e-7 it is.

    Parameters
    ----------
    value, gradient
        Vectors of one shape; `step` changes the first by the second.
    """

    def __init__(self, value: torch.Tensor, gradient: torch.Tensor) -> None:
        self._value = value
        self._gradient = gradient
        self._mean = torch.zeros_like(value)
        self._norm = torch.zeros_like(value)
        self._scratch = torch.empty_like(value)
        self._decay = 1.0

    def step(self) -> None:
        """Move the parameters once."""
        self._decay *= _BETA_1
        self._mean.lerp_(self._gradient, 1.0 - _BETA_1)
        torch.abs(self._gradient, out=self._scratch)
        torch.maximum(self._norm.mul_(_BETA_2), self._scratch, out=self._norm)
        torch.add(self._norm, _EPSILON, out=self._scratch)
        self._value.addcdiv_(self._mean, self._scratch, value=-RATE / (1.0 - self._decay))
