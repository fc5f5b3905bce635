"""One step of an axis in one mode: exact where it is linear, of third order elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sim.dynamics.equations import linear_part, remainder
from sim.dynamics.modes import Mode
from sim.dynamics.operators import exponential_operators
from sim.dynamics.state import SCALES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sim.dynamics.parameters import AxisParameters

_SCALES = np.array(SCALES)
_WEAKLY_DAMPED = 0.3


class Step(NamedTuple):
    """What a step leads to.

    Attributes
    ----------
    stages
        States at a third, at two thirds and at the whole of it.
    error
        Estimate of the largest error, in units of `sim.dynamics.state.SCALES`.
    """

    stages: tuple[list[float], list[float], list[float]]
    error: float


class Stepper:
    """Steps of an axis, whose operators are kept for each mode and step.

    The method is an exponential Runge-Kutta method of Hochbruck and Ostermann (Exponential
    integrators, Acta Numerica 19, 2010, section 2.3, with nodes 0, 1/3 and 2/3): three stages and
    order three, with a method of order two of the first two stages inside for the error. It is
    exact where the remainder is constant, and so stable at any step where the axis by itself is.

    Parameters
    ----------
    axis
        Whose equations.
    """

    def __init__(self, axis: AxisParameters) -> None:
        self.axis = axis
        self._linear: dict[Mode, NDArray[np.float64]] = {}
        self._kept: dict[tuple[Mode, float], tuple[NDArray[np.float64], ...]] = {}
        self._limits: dict[Mode, float] = {}

    def step(self, state: Sequence[float], mode: Mode, acceleration: float, step_s: float) -> Step:
        """Take a step; nothing that ends the mode is looked for.

        Parameters
        ----------
        state
            At its beginning.
        mode
            Throughout.
        acceleration
            That is asked for, rad/s2.
        step_s
            Its length.
        """
        third, two_thirds, whole, bend3, bend = self._operators(mode, step_s)
        axis, start = self.axis, np.asarray(state)
        first = remainder(state, mode, axis, acceleration)
        both = np.concatenate([start, first])
        at3 = (start + third @ both).tolist()
        second = remainder(at3, mode, axis, acceleration) - first
        at23 = (start + two_thirds @ both + bend3 @ second).tolist()
        third_rest = remainder(at23, mode, axis, acceleration) - first
        end = start + whole @ both + bend @ (0.5 * third_rest)
        error = bend @ (0.5 * third_rest - second)
        return Step((at3, at23, end.tolist()), float(np.abs(error / _SCALES).max()))

    def longest_s(self, mode: Mode) -> float:
        """Return a step that cannot leap over what ends a mode: a quarter of a vibration."""
        if mode not in self._limits:
            rates = np.linalg.eigvals(self._matrix(mode))
            swings = rates[np.abs(rates.imag) > _WEAKLY_DAMPED * np.abs(rates.real)]
            fastest = float(np.abs(swings.imag).max(initial=0.0))
            self._limits[mode] = 0.5 * np.pi / fastest if fastest else np.inf
        return self._limits[mode]

    def _matrix(self, mode: Mode) -> NDArray[np.float64]:
        if mode not in self._linear:
            self._linear[mode] = linear_part(self.axis, mode)
        return self._linear[mode]

    def _operators(self, mode: Mode, step_s: float) -> tuple[NDArray[np.float64], ...]:
        # direction, flank and end do not change the matrix
        kind = Mode(*map(abs, mode))
        if (kind, step_s) not in self._kept:
            parts = [
                exponential_operators(self._matrix(kind), share * step_s / 3.0)
                for share in (1, 2, 3)
            ]
            self._kept[kind, step_s] = (
                *(np.hstack([each.change, each.first]) for each in parts),
                parts[1].second * (3.0 / step_s),
                parts[2].second * (3.0 / step_s),
            )
        return self._kept[kind, step_s]
