"""Extreme cases of an axis that moves, against scipy's Radau, and the week that it works."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sim.dynamics.equations import energy_j
from sim.dynamics.findings import Finding
from sim.dynamics.integrate import Integration, at_rest
from sim.dynamics.parameters import STICKY, AxisParameters
from sim.dynamics.reference import ReferenceIntegration
from sim.dynamics.state import DEMAND_SPEED, LOAD, LOST, MOTOR, MOTOR_SPEED
from sim.dynamics.stepper import Stepper
from sim.dynamics.travel import travel

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sim.dynamics.travel import Run

_TOLERANCE, _WORKED_TOLERANCE, _REFERENCE_TOLERANCE = 1e-6, 1e-5, 1e-8
_DAY_S, _CYCLE_S = 86400.0, 3600.0
_LOW, _HIGH, _SPEED, _ACCELERATION = 0.3, 0.9, 0.35, 0.35
_CREEP_RAD_S, _CREEP_S = 2e-4, 5.0


def work(days: float) -> Iterator[Finding]:
    """Move to and fro every hour, and keep the books of the energy."""
    axis = AxisParameters()
    run = Integration(Stepper(axis), at_rest(_LOW), _WORKED_TOLERANCE)
    before = energy_j(run.state, run.mode, axis)
    stands: dict[float, list[float]] = {_LOW: [], _HIGH: []}
    for _ in range(max(2, round(days * _DAY_S / _CYCLE_S))):
        for target, stand in ((_HIGH, stands[_HIGH]), (_LOW, stands[_LOW])):
            travel(run, target, _SPEED, _ACCELERATION)
            run.advance(0.5 * _CYCLE_S)
            stand.append(run.state[LOAD])
    books = energy_j(run.state, run.mode, axis) - before + run.state[LOST]
    apart = max(max(stand[1:]) - min(stand[1:]) for stand in stands.values())
    off = max(abs(each - target) for target, stand in stands.items() for each in stand)
    case = f"{days:g} days of moves, to and fro every hour"
    yield Finding(case, "energy missing from the books", abs(books), 1e-2, "J")
    yield Finding(case, "repeats of a position apart", 1e6 * apart, 1e-2, "µrad")
    yield Finding(
        case, "largest distance from the target", 1e6 * off, 1e6 * _standing(axis), "µrad"
    )


def creep() -> Iterator[Finding]:
    """Creep so slowly that friction sticks and slips."""
    case = "friction near zero speed, 0.2 mrad/s"
    run = Integration(Stepper(STICKY), at_rest(0.5), _TOLERANCE)
    reference = ReferenceIntegration(STICKY, at_rest(0.5), "Radau", _REFERENCE_TOLERANCE)
    for each in (run, reference):
        each.state[DEMAND_SPEED] = _CREEP_RAD_S
    error = moved = stuck = 0.0
    for _ in range(50):
        held = not run.mode.slides
        motor, events = run.state[MOTOR], run.events
        for each in (run, reference):
            each.advance(_CREEP_S / 50)
        error = max(error, abs(run.state[LOAD] - reference.state[LOAD]))
        if held and run.events == events:
            stuck += 1
            moved = max(moved, abs(run.state[MOTOR] - motor), abs(run.state[MOTOR_SPEED]))
    yield Finding(case, "largest difference from Radau", 1e6 * error, 1e-2, "µrad")
    yield Finding(case, "motion while it sticks", moved, 0.0, "rad")
    yield Finding(
        case,
        "sticks and slips that Radau has more or less",
        abs(run.events - reference.events),
        0.0,
        "",
    )


def inertia() -> Iterator[Finding]:
    """Move a load with ten thousand times the motor's inertia."""
    axis = replace(
        AxisParameters(), motor_inertia=0.1, load_inertia=1e3, stiffness=9.87e5, damping=628.0
    )
    yield from _against("an inertia ratio of 10,000", axis, 0.5, 0.7, 1e-2)


def stop() -> Iterator[Finding]:
    """Run into the upper end stop at full speed."""
    axis = AxisParameters()
    yield from _against("an end stop at 20 deg/s", axis, 1.2, 1.65, 1e-2)


def reversal() -> Iterator[Finding]:
    """Carry the load over the vertical, where it falls through the gear's play."""
    axis = replace(AxisParameters(), low_rad=-1.6, play_rad=2e-3)
    yield from _against("a load that falls through 2 mrad of play", axis, -0.2, 0.2, 1e-2)


def _against(
    case: str, axis: AxisParameters, start: float, target: float, bound_urad: float
) -> Iterator[Finding]:
    def follow(run: Run) -> list[float]:
        travel(run, target, _SPEED, _ACCELERATION)
        seen = [run.state[LOAD]]
        for _ in range(4):
            run.advance(0.25)
            seen.append(run.state[LOAD])
        return seen

    run = Integration(Stepper(axis), at_rest(start), _TOLERANCE)
    before = energy_j(run.state, run.mode, axis)
    ours = follow(run)
    books = energy_j(run.state, run.mode, axis) - before + run.state[LOST]
    reference = ReferenceIntegration(axis, at_rest(start), "Radau", _REFERENCE_TOLERANCE)
    error = max(abs(one - two) for one, two in zip(ours, follow(reference), strict=True))
    yield Finding(case, "largest difference from Radau", 1e6 * error, bound_urad, "µrad")
    yield Finding(case, "energy missing from the books", abs(books), 1e-3, "J")


def _standing(axis: AxisParameters) -> float:
    """Return how far from its target a load may come to rest, rad."""
    servo = axis.position_gain * axis.torque_constant / axis.resistance_ohm
    pull = axis.gravity_nm + axis.static_nm
    return pull / servo + axis.gravity_nm / axis.stiffness + 0.5 * axis.play_rad
