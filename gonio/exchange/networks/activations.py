"""Activations as formulas: those of `nnbrdf.activations`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gonio.exchange.networks.expression import (
    absolute,
    erf,
    exp,
    input_named,
    log,
    maximum,
    minimum,
    sin,
    tanh,
    where_less,
)
from nnbrdf.activations import (
    ELU_ALPHA,
    RRELU_LOWER,
    RRELU_UPPER,
    SELU_ALPHA,
    SELU_SCALE,
    SHRINK,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.exchange.networks.expression import Expression

X = input_named("x")


def activation_of(name: str) -> Expression:
    """Return the formula of an activation, of `X`."""
    return ACTIVATIONS[name](X)


def _sigmoid(x: Expression) -> Expression:
    return 1.0 / (1.0 + exp(0.0 - x))


def _elu(x: Expression, alpha: float = ELU_ALPHA) -> Expression:
    return where_less(0.0, x, x, alpha * (exp(minimum(x, 0.0)) - 1.0))


def _softplus(x: Expression) -> Expression:
    return maximum(x, 0.0) + log(1.0 + exp(0.0 - absolute(x)))


def _snake(x: Expression) -> Expression:
    sine = sin(x)
    return x + sine * sine


def _softshrink(x: Expression) -> Expression:
    return maximum(x - SHRINK, 0.0) + minimum(x + SHRINK, 0.0)


ACTIVATIONS: dict[str, Callable[[Expression], Expression]] = {
    "linear": lambda x: x,
    "sigmoid": _sigmoid,
    "exponential": exp,
    "tanh": tanh,
    "relu": lambda x: maximum(x, 0.0),
    "elu": _elu,
    "selu": lambda x: SELU_SCALE * _elu(x, SELU_ALPHA),
    "softplus": _softplus,
    "tanhshrink": lambda x: x - tanh(x),
    "softsign": lambda x: x / (1.0 + absolute(x)),
    "hardshrink": lambda x: where_less(SHRINK, absolute(x), x, 0.0),
    "lisht": lambda x: x * tanh(x),
    "swish": lambda x: x * _sigmoid(x),
    "hard-sigmoid": lambda x: minimum(maximum(0.2 * x + 0.5, 0.0), 1.0),
    "snake": _snake,
    "mish": lambda x: x * tanh(_softplus(x)),
    "gelu": lambda x: x * (0.5 * erf(x * math.sqrt(0.5)) + 0.5),
    "rrelu": lambda x: where_less(x, 0.0, (RRELU_LOWER + RRELU_UPPER) / 2 * x, x),
    "softshrink": _softshrink,
}
"""By the names of `nnbrdf.activations.ACTIVATIONS`; softmax is none, as it mixes features."""
