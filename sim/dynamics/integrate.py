"""An axis over any time: steps as long as they may be, and what ends a mode met to rounding."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from sim.dynamics.modes import margins, mode_of, next_mode
from sim.dynamics.rest import is_quiet
from sim.dynamics.state import MOTOR_SPEED

if TYPE_CHECKING:
    from sim.dynamics.modes import Mode
    from sim.dynamics.stepper import Step, Stepper

_SHORTEST, _LONGEST = -44, 30
_SHORTEST_S = math.ldexp(1.0, _SHORTEST)
# of rounding, where a mode begins: rad, rad/s or N m
_SLACK, _REACHED = 1e-14, 1e-12
# twice the step makes eight times the error
_GROWS_BELOW = 0.1


@dataclass
class Integration:
    """An axis on its way; `advance` moves it on.

    Attributes
    ----------
    stepper
        Takes the steps.
    state
        Where it is, nine numbers (`sim.dynamics.state`).
    tolerance
        Of the error of one step, in units of `sim.dynamics.state.SCALES`.
    mode
        Which piece it is on.
    steps, events
        How many were taken and met.
    """

    stepper: Stepper
    state: list[float]
    tolerance: float = 1e-9
    mode: Mode = field(init=False)
    steps: int = 0
    events: int = 0
    _power: int = -10
    _within: int | None = None
    _which: int = 0

    def __post_init__(self) -> None:
        """Find the mode that it begins in."""
        self.mode = mode_of(self.state, self.stepper.axis)

    def advance(self, seconds: float, acceleration: float = 0.0) -> None:
        """Let time pass while a constant acceleration is asked for, rad/s2.

        Steps are powers of two, so that their operators are made once: a time is a sum of them, and
        what ends a mode is found by halving.
        """
        left = seconds
        while left >= _SHORTEST_S:
            if self._within is not None:
                left -= self._approach(self._within, acceleration)
            else:
                power = min(self._power, self._longest(acceleration), _power_below(left))
                left -= self._step(power, acceleration)
        self._within = None

    def _longest(self, acceleration: float) -> int:
        if is_quiet(self.state, self.mode, self.stepper.axis, acceleration):
            return _LONGEST
        return _power_below(self.stepper.longest_s(self.mode))

    def _step(self, power: int, acceleration: float) -> float:
        """Take a step of 2^power s if it is good, and return how long it was."""
        step = self._try(power, acceleration)
        if step.error > self.tolerance and power > _SHORTEST:
            self._power = power - 1
            return 0.0
        ends = self._ends(step)
        if ends is not None:
            self._within, self._which = power, ends
            return 0.0
        self.state = step.stages[-1]
        if step.error < _GROWS_BELOW * self.tolerance and power == self._power < _LONGEST:
            self._power += 1
        return math.ldexp(1.0, power)

    def _approach(self, within: int, acceleration: float) -> float:
        """Halve the time in which the mode ends, and let it end where no half is left."""
        power = max(within - 1, _SHORTEST)
        step = self._try(power, acceleration)
        ends = self._ends(step)
        self._within = power
        if ends is not None:
            self._which = ends
            if power > _SHORTEST:
                return 0.0
        self.state = step.stages[-1]
        if within == _SHORTEST:
            self._within = None
            # so short a step may move nothing by as much as rounding: the mode ends all the same
            margin = margins(self.state, self.mode, self.stepper.axis)[self._which]
            if margin < _REACHED:
                self._change(self._which)
        return math.ldexp(1.0, power)

    def _try(self, power: int, acceleration: float) -> Step:
        self.steps += 1
        return self.stepper.step(self.state, self.mode, acceleration, math.ldexp(1.0, power))

    def _ends(self, step: Step) -> int | None:
        """Return the number of the margin that a step oversteps, or None."""
        for stage in step.stages:
            for number, margin in enumerate(margins(stage, self.mode, self.stepper.axis)):
                if margin < -_SLACK:
                    return number
        return None

    def _change(self, which: int) -> None:
        self.events += 1
        self.mode = next_mode(self.state, self.mode, which, self.stepper.axis)
        if not self.mode.slides:
            self.state[MOTOR_SPEED] = 0.0


def at_rest(position: float) -> list[float]:
    """Return the state of an axis that stands at a position, rad, and is asked to."""
    return [0.0, 0.0, position, 0.0, position, 0.0, 0.0, position, 0.0]


def _power_below(seconds: float) -> int:
    return _LONGEST if seconds == math.inf else max(math.frexp(seconds)[1] - 1, _SHORTEST)
