"""Moves of one axis at a time: how long until in position, and until still."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.bench.fit import Profile, fit_line, fit_profile, fit_ring_down
from gonio.errors import BadInputError
from gonio.paths import blocked
from gonio.rig import AXES
from gonio.timing import AxisTiming, Spread

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from gonio.capture import Instrument
    from gonio.rig import Axis, Rig

    Array = NDArray[np.float64]

LENGTHS: Final = 8
"""Lengths of the moves of each axis, each taken both ways."""

_SHORTEST, _LONGEST = 0.005, 0.9
_HOMED_FROM = (0.15, 0.5, 0.85)
"""Where in its travel an axis stands before it is homed."""

STEPS: Final = len(AXES) * (2 * LENGTHS + len(_HOMED_FROM) + 1)
"""How often `AxisBench` tells its progress, over all axes."""

_RING_POLL_S = 0.02
_RING_POLLS = 100
_MOVING = 65535


@dataclass(frozen=True)
class AxisResult:
    """What was found of one axis.

    Attributes
    ----------
    distance_deg, arrived_s, settled_s
        Of each move: how far, until in position, and from then until still; shape (n,).
    profile
        Explains `arrived_s`.
    timing
        All of it, for the time model.
    ring_down_s
        Of the axis' arm.
    """

    distance_deg: Array
    arrived_s: Array
    settled_s: Array
    profile: Profile
    timing: AxisTiming
    ring_down_s: float


class AxisBench:
    """Moves the axes of a rig one at a time, the others parked out of the way.

    Parameters
    ----------
    instrument, rig
        What moves; enabled and homed.
    step
        Called after each step.
    """

    def __init__(self, instrument: Instrument, rig: Rig, step: Callable[[], None]) -> None:
        self._instrument, self._rig, self._step = instrument, rig, step
        self._arm, self._clock = instrument.arm, instrument.clock

    def measure(self, name: str) -> AxisResult:
        """Measure one axis.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When it fails, or its times fit no profile.
        """
        parked, spec = parked_deg(self._rig, name), self._rig.axis[name]
        self._check_clear(parked, name)
        moves = np.array([self._move(parked, name, *ends) for ends in _ways(spec)])
        distance, arrived_s, settled_s = moves.T
        profile = fit_profile(
            distance, arrived_s, spec.max_velocity_deg_s, spec.max_acceleration_deg_s2
        )
        ring_down_s = self._ring_down(parked, name)
        homing_s, homing_deg_s = self._homing(parked, name)
        timing = AxisTiming(
            latency_s=profile.latency_s,
            velocity_deg_s=profile.velocity_deg_s,
            acceleration_deg_s2=profile.acceleration_deg_s2,
            jerk_deg_s3=profile.jerk_deg_s3,
            sd_s=profile.residual_s,
            error=profile.error,
            settle=spread_of(settled_s),
            homing_velocity_deg_s=homing_deg_s,
            homing_s=homing_s,
        )
        return AxisResult(distance, arrived_s, settled_s, profile, timing, ring_down_s)

    def _check_clear(self, parked: Mapping[str, float], name: str) -> None:
        """Refuse to sweep an axis where that brings the arms too near to each other."""
        ways = [
            [[{**parked, name: end}[axis] for axis in AXES] for end in way]
            for way in _ways(self._rig.axis[name])
        ]
        starts, ends = np.array(ways).transpose(1, 0, 2)
        if any(blocked(starts, ends, self._rig)):
            raise BadInputError(
                f"{name}: swept over all of its travel, it brings the arms nearer to each other "
                "than arm.min_separation_deg; measure with that at 0 if the arms can pass each "
                "other, or plan without --timing"
            )

    def _move(
        self, parked: Mapping[str, float], name: str, start_deg: float, end_deg: float
    ) -> tuple[float, float, float]:
        self._instrument.move_clear({**parked, name: start_deg}, self._rig)
        began = self._clock.now()
        # all four are told, as in a capture: telling them is part of the time
        self._arm.go({**parked, name: end_deg})
        arrived = self._clock.now()
        self._arm.settle(parked)
        self._step()
        return end_deg - start_deg, arrived - began, self._clock.now() - arrived

    def _ring_down(self, parked: Mapping[str, float], name: str) -> float:
        start_deg, end_deg = _ways(self._rig.axis[name])[-1]
        self._instrument.move_clear({**parked, name: start_deg}, self._rig)
        self._arm.go({**parked, name: end_deg})
        seen = []
        for _ in range(_RING_POLLS):
            seen.append((self._clock.now(), self._arm.shaking_urad(name)))
            self._clock.sleep(_RING_POLL_S)
        self._step()
        times, shaking = np.array(seen, np.float64).T
        return fit_ring_down(times[shaking < _MOVING], shaking[shaking < _MOVING])

    def _homing(self, parked: Mapping[str, float], name: str) -> tuple[float, float]:
        spec = self._rig.axis[name]
        ways, times = [], []
        for share in _HOMED_FROM:
            start_deg = spec.min_deg + share * (spec.max_deg - spec.min_deg)
            self._instrument.move_clear({**parked, name: start_deg}, self._rig)
            began = self._clock.now()
            self._arm.home(anew=(name,))
            ways.append(abs(start_deg - spec.to_degrees(0)))
            times.append(self._clock.now() - began)
            self._step()
        return fit_line(np.array(ways), np.array(times))


def parked_deg(rig: Rig, name: str) -> dict[str, float]:
    """Return where the axes stand while one of them is measured.

    The other arm lies at its lowest, on the far side; this one is upright when its azimuth is
    measured, and at azimuth 0 when its polar angle is.
    """
    arm = name.partition("_")[0]
    other = "light" if arm == "view" else "view"
    wanted = {f"{arm}_theta": 0.0, f"{arm}_phi": 0.0, f"{other}_theta": 90.0, f"{other}_phi": 180.0}
    return {
        axis: min(max(angle, rig.axis[axis].min_deg), rig.axis[axis].max_deg)
        for axis, angle in wanted.items()
    }


def _ways(spec: Axis) -> list[tuple[float, float]]:
    """Return start and end of each move, there and back, from short to long."""
    travel = spec.max_deg - spec.min_deg
    ends = spec.min_deg + travel * np.geomspace(_SHORTEST, _LONGEST, LENGTHS)
    there = [(spec.min_deg, float(end)) for end in ends]
    return [way for start, end in there for way in ((start, end), (end, start))]


def spread_of(times_s: NDArray[np.float64]) -> Spread:
    """Return mean and spread of times, shape (n,)."""
    sd_s = float(np.std(times_s, ddof=1)) if len(times_s) > 1 else 0.0
    return Spread(
        mean_s=float(np.mean(times_s)), sd_s=sd_s, error_s=sd_s / float(np.sqrt(len(times_s)))
    )
