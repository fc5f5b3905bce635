"""An arm that swings: a lightly damped mode, driven by the accelerations of its axes."""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sim.vibration import MOVING, Vibration

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sim.motion import Motion

_FORGOTTEN = 1e-9


class _Swing(NamedTuple):
    """One axis' swing after a motion, rad: its real part, and what it would be a quarter later."""

    time_s: float
    phasor: complex


class FlexibleArm(Vibration):
    """Vibration as the swings that motions leave, added with their phases.

    The end follows q'' + 2 d w q' + w2 q = -a; a motion is steps of its acceleration a, and the
    response to a step is known in closed form.

    Parameters
    ----------
    resonance_hz, damping
        w / 2 pi, and d as a share of the critical one.
    """

    def __init__(self, resonance_hz: float, damping: float) -> None:
        super().__init__()
        rate = 2.0 * math.pi * resonance_hz
        self._rate, self._ratio = rate, damping / math.sqrt(1.0 - damping**2)
        self._pole = complex(-damping * rate, rate * math.sqrt(1.0 - damping**2))
        self._swings: dict[str, list[_Swing]] = {}

    def kick(self, axis: str, motion: Motion, counts_per_deg: float) -> None:
        """Add what a motion leaves when it ends."""
        per_count = math.radians(1.0) / counts_per_deg
        end_s = motion.end_s - motion.start_s
        phasor, before = 0j, 0.0
        for past_s, acceleration in [
            *((piece.start_s, piece.acceleration) for piece in motion.pieces), (end_s, 0.0)
        ]:  # fmt: skip
            step = per_count * (acceleration - before) / self._rate**2
            phasor += step * complex(1.0, -self._ratio) * cmath.exp(self._pole * (end_s - past_s))
            before = acceleration
        kept = [s for s in self._swings.get(axis, []) if self._left(s, motion.end_s) > _FORGOTTEN]
        self._swings[axis] = [*kept, _Swing(motion.end_s, phasor)]

    def deflection_rad(self, axis: str, times_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far an axis' swing has the end off, at times since its last motion."""
        total = np.zeros_like(times_s)
        for swing in self._swings.get(axis, []):
            total += (swing.phasor * np.exp(self._pole * (times_s - swing.time_s))).real
        return total

    def settle_urad(self, now: float) -> int:
        """Return what the settle register says: the peak over the last 500 ms."""
        if any(moving() for moving in self.axes_moving):
            return MOVING
        ends = [swing.time_s for swings in self._swings.values() for swing in swings]
        times = self.window(now, ends)
        return min(round(1e6 * max(map(self._envelope_rad, times))), MOVING - 1)

    def _envelope_rad(self, time_s: float) -> float:
        return math.hypot(
            *(
                abs(
                    sum(
                        s.phasor * cmath.exp(self._pole * (time_s - s.time_s))
                        for s in swings
                        if s.time_s <= time_s
                    )
                )
                for swings in self._swings.values()
            )
        )

    def _left(self, swing: _Swing, now: float) -> float:
        return abs(swing.phasor) * math.exp(self._pole.real * (now - swing.time_s))
