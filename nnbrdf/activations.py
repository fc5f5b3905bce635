"""The twenty activations of the paper's tables, by name, with their usual parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Activation = Callable[[NDArray[Any]], NDArray[Any]]

ELU_ALPHA = 1.0
SELU_SCALE, SELU_ALPHA = 1.0507009873554804934, 1.6732632423543772848
SHRINK = 0.5
RRELU_LOWER, RRELU_UPPER = 1 / 8, 1 / 3


def linear(x: NDArray[Any]) -> NDArray[Any]:
    """Return x: the network is then a linear map."""
    return x


def sigmoid(x: NDArray[Any]) -> NDArray[Any]:
    """Return 1 / (1 + exp(-x))."""
    from scipy.special import expit

    return _array(expit(x))


def exponential(x: NDArray[Any]) -> NDArray[Any]:
    """Return exp(x), infinite where that overflows."""
    with np.errstate(over="ignore"):
        return _array(np.exp(x))


def tanh(x: NDArray[Any]) -> NDArray[Any]:
    """Return the hyperbolic tangent."""
    return _array(np.tanh(x))


def relu(x: NDArray[Any]) -> NDArray[Any]:
    """Return max(x, 0) (Nair and Hinton 2010)."""
    return _array(np.maximum(x, 0.0))


def elu(x: NDArray[Any]) -> NDArray[Any]:
    """Return x above 0 and exp(x) - 1 below (Clevert et al. 2016, alpha = 1)."""
    return _array(np.where(x > 0, x, ELU_ALPHA * np.expm1(np.minimum(x, 0.0))))


def selu(x: NDArray[Any]) -> NDArray[Any]:
    """Return the ELU, scaled so that activations keep their variance (Klambauer et al. 2017)."""
    return _array(SELU_SCALE * np.where(x > 0, x, SELU_ALPHA * np.expm1(np.minimum(x, 0.0))))


def softplus(x: NDArray[Any]) -> NDArray[Any]:
    """Return ln(1 + exp(x)) (Dugas et al. 2001)."""
    return _array(np.logaddexp(x, 0.0))


def tanhshrink(x: NDArray[Any]) -> NDArray[Any]:
    """Return x - tanh(x)."""
    return _array(x - np.tanh(x))


def softsign(x: NDArray[Any]) -> NDArray[Any]:
    """Return x / (1 + |x|) (Bergstra et al. 2009)."""
    return _array(x / (1.0 + np.abs(x)))


def hardshrink(x: NDArray[Any]) -> NDArray[Any]:
    """Return x where |x| > 0.5, and 0 elsewhere."""
    return _array(np.where(np.abs(x) > SHRINK, x, 0.0))


def lisht(x: NDArray[Any]) -> NDArray[Any]:
    """Return x tanh(x) (Roy et al. 2019)."""
    return _array(x * np.tanh(x))


def swish(x: NDArray[Any]) -> NDArray[Any]:
    """Return x times its sigmoid (Ramachandran et al. 2017, beta = 1)."""
    return _array(x * sigmoid(x))


def hard_sigmoid(x: NDArray[Any]) -> NDArray[Any]:
    """Return 0.2 x + 0.5, held between 0 and 1 (Courbariaux et al. 2015, as Keras 2 has it)."""
    return _array(np.clip(0.2 * x + 0.5, 0.0, 1.0))


def snake(x: NDArray[Any]) -> NDArray[Any]:
    """Return x + sin(x)^2 (Ziyin et al. 2020, frequency 1)."""
    return _array(x + np.sin(x) ** 2)


def mish(x: NDArray[Any]) -> NDArray[Any]:
    """Return x tanh(softplus(x)) (Misra 2020)."""
    return _array(x * np.tanh(softplus(x)))


def gelu(x: NDArray[Any]) -> NDArray[Any]:
    """Return x times the normal distribution's share below x (Hendrycks and Gimpel 2016)."""
    from scipy.special import ndtr

    return _array(x * ndtr(x))


def softmax(x: NDArray[Any]) -> NDArray[Any]:
    """Return exp(x), normalized to a sum of 1 over the features, the last axis but one."""
    e = np.exp(x - x.max(axis=-2, keepdims=True))
    return _array(e / e.sum(axis=-2, keepdims=True))


def rrelu(x: NDArray[Any]) -> NDArray[Any]:
    """Return x above 0 and 11/48 x below (Xu et al. 2015).

    In training the slope below 0 is drawn between 1/8 and 1/3 for every sample, feature and step;
    11/48 is its mean.
    """
    return _array(np.where(x < 0, (RRELU_LOWER + RRELU_UPPER) / 2 * x, x))


def softshrink(x: NDArray[Any]) -> NDArray[Any]:
    """Return x moved by 0.5 towards 0, and 0 where |x| <= 0.5."""
    return _array(np.sign(x) * np.maximum(np.abs(x) - SHRINK, 0.0))


def _array(x: NDArray[Any]) -> NDArray[Any]:
    return x


ACTIVATIONS: dict[str, Activation] = {
    "linear": linear,
    "sigmoid": sigmoid,
    "exponential": exponential,
    "tanh": tanh,
    "relu": relu,
    "elu": elu,
    "selu": selu,
    "softplus": softplus,
    "tanhshrink": tanhshrink,
    "softsign": softsign,
    "hardshrink": hardshrink,
    "lisht": lisht,
    "swish": swish,
    "hard-sigmoid": hard_sigmoid,
    "snake": snake,
    "mish": mish,
    "gelu": gelu,
    "softmax": softmax,
    "rrelu": rrelu,
    "softshrink": softshrink,
}
"""In the order of the compiled trainer's numbers; each takes features on the last axis but one."""


def activation_named(name: str) -> Activation:
    """Return an activation.

    Raises
    ------
    BadInputError
        For an unknown name, listing the known.
    """
    if name not in ACTIVATIONS:
        raise BadInputError(f"activation {name!r} is not known; use {', '.join(ACTIVATIONS)}")
    return ACTIVATIONS[name]
