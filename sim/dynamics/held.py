"""Extreme cases of an axis whose motor is held, which have a solution in closed form."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from typing import TYPE_CHECKING

from sim.dynamics.equations import energy_j
from sim.dynamics.findings import Finding
from sim.dynamics.integrate import Integration, at_rest
from sim.dynamics.modes import Mode
from sim.dynamics.parameters import AxisParameters
from sim.dynamics.state import CURRENT, DEMAND, LOAD, WARMTH
from sim.dynamics.stepper import Stepper

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

WEEK_S = 604800.0
_HELD = replace(AxisParameters(), static_nm=math.inf, play_rad=0.0, gravity_nm=0.0)
_LOSSLESS = replace(_HELD, damping=0.0, bearing=0.0)
_MODE = Mode(slides=0, flank=1, stop=0)
_AMPLITUDE_RAD = 1e-3
_LOCKED_ERROR_RAD = 1e-3
_LOOKS_S = (1e-5, 1e-4, 1e-2, 1.0, 1e3, 1e4)


def undamped_week(step_s: float = 60.0) -> Iterator[Finding]:
    """Swing for a week without any loss, in steps of one length."""
    stepper, state = Stepper(_LOSSLESS), _swinging()
    before = energy_j(state, _MODE, _LOSSLESS)
    energy = error = 0.0
    for number in range(1, round(WEEK_S / step_s) + 1):
        state = stepper.step(state, _MODE, 0.0, step_s).stages[-1]
        energy = max(energy, abs(energy_j(state, _MODE, _LOSSLESS) / before - 1.0))
        error = max(error, abs(state[LOAD] - _swing(_LOSSLESS, step_s * number)))
    case = f"a week's swing of 1 mrad without loss, steps of {step_s:g} s"
    yield Finding(case, "energy gained or lost, of all", energy, 1e-8, "")
    yield Finding(case, "largest error of position", 1e6 * error, 1e-4, "µrad")


def any_step(steps_s: Sequence[float] = (1e-7, 1e-5, 1e-3, 0.1, 60.0)) -> Iterator[Finding]:
    """Let a swing with its losses decay in steps of very different lengths."""
    for step_s in steps_s:
        stepper, state = Stepper(_HELD), _swinging()
        steps = min(20_000, max(1, round(60.0 / step_s)))
        energy, error, most = energy_j(state, _MODE, _HELD), 0.0, 0.0
        for number in range(1, steps + 1):
            state = stepper.step(state, _MODE, 0.0, step_s).stages[-1]
            before, energy = energy, energy_j(state, _MODE, _HELD)
            most = max(most, energy - before)
            error = max(error, abs(state[LOAD] - _swing(_HELD, step_s * number)))
        case = f"a step of {step_s:g} s, {steps} of them"
        yield Finding(case, "largest error of position", 1e6 * error, 1e-6, "µrad")
        yield Finding(case, "energy gained in any step", most, 1e-15, "J")


def locked_rotor() -> Iterator[Finding]:
    """Push against a locked rotor from microseconds to ten thermal time constants."""
    run = Integration(Stepper(_HELD), at_rest(0.5), 1e-9)
    run.state[DEMAND] += _LOCKED_ERROR_RAD
    past_s = current = warmth = 0.0
    for look_s in _LOOKS_S:
        run.advance(look_s - past_s)
        past_s = look_s
        amperes, kelvin = _locked(look_s)
        current = max(current, abs(run.state[CURRENT] / amperes - 1.0))
        warmth = max(warmth, abs(run.state[WARMTH] / kelvin - 1.0))
    case = "a locked rotor, 10 V, from 10 µs to 10,000 s"
    yield Finding(case, "largest relative error of the current", current, 1e-8, "")
    yield Finding(case, "largest relative error of the warming", warmth, 1e-6, "")
    yield Finding(case, "steps that it took", run.steps, 20_000, "")


def _swinging() -> list[float]:
    state = at_rest(0.0)
    state[LOAD] = _AMPLITUDE_RAD
    return state


def _swing(axis: AxisParameters, time_s: float) -> float:
    """Return where the load is after a release from rest, by the formula of a damped swing."""
    decay = 0.5 * (axis.damping + axis.bearing) / axis.load_inertia
    rate = math.sqrt(axis.stiffness / axis.load_inertia - decay**2)
    turn = cmath.exp(complex(-decay, rate) * time_s)
    return _AMPLITUDE_RAD * (turn.real + decay / rate * turn.imag)


def _locked(time_s: float) -> tuple[float, float]:
    """Return current and warming at a constant voltage, A and K."""
    axis = _HELD
    end_a = axis.position_gain * _LOCKED_ERROR_RAD / axis.resistance_ohm
    current = -end_a * math.expm1(-time_s / axis.electrical_s)
    # i2 = end2 (1 - 2 exp(-t / el) + exp(-2 t / el)), each term seen through the thermal lag
    slow = 1.0 / axis.thermal_s
    warmth = sum(
        share * (math.expm1(-rate * time_s) - math.expm1(-slow * time_s)) / (slow - rate)
        for share, rate in (
            (1.0, 0.0),
            (-2.0, 1.0 / axis.electrical_s),
            (1.0, 2.0 / axis.electrical_s),
        )
    )
    return current, axis.resistance_ohm * end_a**2 / axis.heat_capacity * warmth
