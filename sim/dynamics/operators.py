"""Exponential of a matrix and its integrals, exact to rounding at any step."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.linalg import matrix_balance

if TYPE_CHECKING:
    from numpy.typing import NDArray

_TERMS = 18
_LARGEST_NORM = 0.5


class Operators(NamedTuple):
    """What a step h of x' = L x + n needs, each of shape (n, n).

    `change` is exp(hL) - 1; `first` and `second` are the integrals over the step of exp((h - s)L)
    and of exp((h - s)L) s, which a constant n and one that grows with time enter by.
    """

    change: NDArray[np.float64]
    first: NDArray[np.float64]
    second: NDArray[np.float64]


def exponential_operators(linear: NDArray[np.float64], step_s: float) -> Operators:
    """Return the operators of a step by a Taylor series of a small one, and doubling.

    Doubling goes by exp(hL) - 1, not by exp(hL): of a mode that is slow against the fastest one the
    latter would lose as many digits as it is doubled (Higham, Functions of Matrices, ch. 10).

    Parameters
    ----------
    linear
        L, shape (n, n).
    step_s
        h.
    """
    balanced, (scale, _) = matrix_balance(linear, permute=False, separate=True)
    norm = step_s * float(np.abs(balanced).sum(axis=0).max())
    doublings = max(0, math.ceil(math.log2(norm / _LARGEST_NORM))) if norm else 0
    small_s = math.ldexp(step_s, -doublings)
    operators = _series(balanced, small_s)
    for power in range(doublings):
        operators = _doubled(operators, math.ldexp(small_s, power))
    return Operators(*(scale[:, None] * each / scale for each in operators))


def _series(linear: NDArray[np.float64], step_s: float) -> Operators:
    # term k is h^k L^k / k!; the integrals have the same terms with k + 1 and k + 2
    term = np.eye(len(linear))
    change, first, second = np.zeros_like(term), np.zeros_like(term), np.zeros_like(term)
    for k in range(_TERMS):
        first += term * (step_s / (k + 1))
        second += term * (step_s**2 / ((k + 1) * (k + 2)))
        term = term @ linear * (step_s / (k + 1))
        change += term
    return Operators(change, first, second)


def _doubled(half: Operators, step_s: float) -> Operators:
    change, first, second = half
    return Operators(
        2.0 * change + change @ change,
        2.0 * first + change @ first,
        2.0 * second + change @ second + step_s * first,
    )
