"""Moves of an axis as its drive asks for them."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Protocol

from sim.dynamics.state import DEMAND, DEMAND_SPEED
from sim.motion import go

if TYPE_CHECKING:
    from sim.dynamics.modes import Mode


class Run(Protocol):
    """An axis on its way, by whatever method."""

    state: list[float]
    mode: Mode
    events: int

    def advance(self, seconds: float, acceleration: float = 0.0) -> None:
        """Let time pass while a constant acceleration is asked for, rad/s2."""


def travel(run: Run, target: float, speed: float, acceleration: float) -> None:
    """Ask for a trapezoid from rest to a target, rad, and follow it to its end.

    Parameters
    ----------
    run
        An axis whose demand stands still.
    target
        Where to, rad.
    speed, acceleration
        Of the trapezoid, rad/s and rad/s2.
    """
    motion = go(0.0, run.state[DEMAND], 0.0, target, speed, acceleration)
    ends = [*(piece.start_s for piece in motion.pieces), motion.end_s]
    for piece, (begin_s, end_s) in zip(motion.pieces, pairwise(ends), strict=True):
        run.advance(end_s - begin_s, piece.acceleration)
    # rounding leaves a hair of speed, and an axis that is asked to creep never comes to rest
    run.state[DEMAND], run.state[DEMAND_SPEED] = target, 0.0
