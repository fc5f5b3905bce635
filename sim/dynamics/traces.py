"""An axis watched: what a page draws of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sim.dynamics.integrate import Integration, at_rest
from sim.dynamics.parameters import STICKY, AxisParameters
from sim.dynamics.state import DEMAND, DEMAND_SPEED, LOAD, MOTOR
from sim.dynamics.stepper import Stepper

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

_LOOK_S = 2.0**-7
_TOLERANCE = 1e-5


class Trace(NamedTuple):
    """What was seen: times in s, angles in rad, all of shape (n,)."""

    seconds: NDArray[np.float64]
    demand: NDArray[np.float64]
    motor: NDArray[np.float64]
    load: NDArray[np.float64]


def move_trace() -> Trace:
    """Watch a move of 20 deg at up to 20 deg/s, and three seconds of the ringing after it."""
    run = Integration(Stepper(AxisParameters()), at_rest(0.5), _TOLERANCE)
    return _watched(run, [(1.0, 0.35), (1.0, -0.35), (3.0, 0.0)])


def creep_trace() -> Trace:
    """Watch an axis that is asked for 0.2 mrad/s, and sticks and slips."""
    # without the load's weight the picture shows nothing but the friction
    run = Integration(Stepper(replace(STICKY, gravity_nm=0.0)), at_rest(0.5), _TOLERANCE)
    run.state[DEMAND_SPEED] = 2e-4
    return _watched(run, [(12.0, 0.0)])


def _watched(run: Integration, phases: Iterable[tuple[float, float]]) -> Trace:
    rows = []
    for seconds, acceleration in phases:
        for _ in range(round(seconds / _LOOK_S)):
            rows.append([run.state[place] for place in (DEMAND, MOTOR, LOAD)])
            run.advance(_LOOK_S, acceleration)
    demand, motor, load = np.array(rows).T
    return Trace(np.linspace(0.0, _LOOK_S * (len(rows) - 1), len(rows)), demand, motor, load)
