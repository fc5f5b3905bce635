"""Error against run time: one move, by gonio's method and by scipy's."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sim.dynamics.integrate import Integration, at_rest
from sim.dynamics.parameters import AxisParameters
from sim.dynamics.reference import ReferenceIntegration
from sim.dynamics.state import LOAD
from sim.dynamics.stepper import Stepper
from sim.dynamics.travel import travel

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from sim.dynamics.travel import Run

OURS = "exponential"
TOLERANCES = {
    OURS: (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8),
    "LSODA": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10),
    "Radau": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8),
    "RK45": (1e-3, 1e-5, 1e-7, 1e-9),
}
"""By method; of scipy's relative, with an absolute one beside it."""

_TRUTH, _TRUTH_TOLERANCE = "DOP853", 1e-12
_START, _TARGET, _SPEED, _ACCELERATION = 0.5, 1.0, 0.35, 0.7
_LOOKS, _LOOK_S = 8, 0.25


@dataclass(frozen=True)
class Result:
    """How one method did: seconds of the processor, and the load's largest error in rad.

    `first_seconds` is a first move, for which the exponential method makes its operators.
    """

    method: str
    tolerance: float
    seconds: float
    first_seconds: float
    error_rad: float
    events: int


def race(tolerances: Mapping[str, Sequence[float]]) -> Iterator[Result]:
    """Run a move of 30 deg and the ringing after it by every method and tolerance.

    Parameters
    ----------
    tolerances
        By method, of `TOLERANCES`.

    Yields
    ------
    Result
        One a run, its error against DOP853 at 1e-12, which takes no part.
    """
    axis = AxisParameters()
    truth = _load(ReferenceIntegration(axis, at_rest(_START), _TRUTH, _TRUTH_TOLERANCE))
    for method, each in tolerances.items():
        for tolerance in each:
            begin = _beginner(axis, method, tolerance)
            first_s, _, _ = _timed(begin)
            seconds, load, events = _timed(begin)
            error = float(np.abs(load - truth).max())
            yield Result(method, tolerance, seconds, first_s, error, events)


def _beginner(axis: AxisParameters, method: str, tolerance: float) -> Callable[[], Run]:
    if method != OURS:
        return lambda: ReferenceIntegration(axis, at_rest(_START), method, tolerance)
    stepper = Stepper(axis)
    return lambda: Integration(stepper, at_rest(_START), tolerance)


def _timed(begin: Callable[[], Run]) -> tuple[float, NDArray[np.float64], int]:
    run = begin()
    began = time.process_time()
    load = _load(run)
    return time.process_time() - began, load, run.events


def _load(run: Run) -> NDArray[np.float64]:
    """Return where the load is at the end of a move and while it rings down, rad."""
    travel(run, _TARGET, _SPEED, _ACCELERATION)
    seen = [run.state[LOAD]]
    for _ in range(_LOOKS):
        run.advance(_LOOK_S)
        seen.append(run.state[LOAD])
    return np.array(seen)
