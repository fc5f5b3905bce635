"""The same axis by scipy's solvers, which know nothing of its linear part but its Jacobian."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sim.dynamics.equations import linear_part, remainder
from sim.dynamics.modes import margins, mode_of, next_mode
from sim.dynamics.state import MOTOR_SPEED, SCALES

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from sim.dynamics.modes import Mode
    from sim.dynamics.parameters import AxisParameters

_SCALES = np.array(SCALES)
_MARGINS = 5
# a piece begins where a margin is zero, and rounding there must not end it
_SLACK = 1e-12
_IMPLICIT = ("Radau", "BDF", "LSODA")


class ReferenceIntegration:
    """An axis on its way, moved on by `scipy.integrate.solve_ivp`.

    Parameters
    ----------
    axis, state
        As for `sim.dynamics.integrate.Integration`.
    method
        Of scipy: RK45, LSODA, Radau, ...
    tolerance
        Relative, and absolute in units of `sim.dynamics.state.SCALES`.

    Attributes
    ----------
    state, mode
        Where it is.
    calls
        How often the right-hand side was asked for.
    events
        How many pieces ended.
    """

    def __init__(
        self, axis: AxisParameters, state: Sequence[float], method: str, tolerance: float
    ) -> None:
        self.axis, self.state = axis, list(state)
        self.mode = mode_of(self.state, axis)
        self.calls = self.events = 0
        self._method, self._tolerance = method, tolerance

    def advance(self, seconds: float, acceleration: float = 0.0) -> None:
        """Let time pass while a constant acceleration is asked for, rad/s2."""
        from scipy.integrate import solve_ivp

        past = 0.0
        while past < seconds:
            solution = solve_ivp(
                self._right_hand_side(acceleration),
                (past, seconds),
                np.array(self.state),
                method=self._method,
                events=[_event(number, self.mode, self.axis) for number in range(_MARGINS)],
                rtol=self._tolerance,
                atol=self._tolerance * _SCALES,
                **self._jacobian(),
            )
            self.calls += solution.nfev
            past, self.state = float(solution.t[-1]), solution.y[:, -1].tolist()
            met = [number for number, times in enumerate(solution.t_events) if len(times)]
            if met:
                self._change(met[0])

    def _right_hand_side(
        self, acceleration: float
    ) -> Callable[[float, NDArray[np.float64]], NDArray[np.float64]]:
        matrix, mode, axis = linear_part(self.axis, self.mode), self.mode, self.axis

        def rates(_: float, state: NDArray[np.float64]) -> NDArray[np.float64]:
            return matrix @ state + remainder(state.tolist(), mode, axis, acceleration)

        return rates

    def _jacobian(self) -> dict[str, Any]:
        # of the linear part, which is nearly all of it: an explicit method takes none
        if self._method not in _IMPLICIT:
            return {}
        matrix = linear_part(self.axis, self.mode)
        return {"jac": lambda time, state: matrix}

    def _change(self, which: int) -> None:
        self.events += 1
        self.mode = next_mode(self.state, self.mode, which, self.axis)
        if not self.mode.slides or which == 0:
            self.state[MOTOR_SPEED] = 0.0


def _event(
    number: int, mode: Mode, axis: AxisParameters
) -> Callable[[float, NDArray[np.float64]], float]:
    def margin(_: float, state: NDArray[np.float64]) -> float:
        return margins(state.tolist(), mode, axis)[number] + _SLACK

    margin.terminal, margin.direction = True, -1  # type: ignore[attr-defined]
    return margin
