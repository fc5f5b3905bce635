"""What is left of a move at the end of an arm: a vibration that rings down."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from sim.motion import Motion

MOVING = 65535
"""What the settle register says while an axis of the arm moves."""

_URAD_PER_DEG_S2 = 10.0
# an envelope of 200 urad after a stop with 20 deg/s2 is below 12 urad half a second later, and the
# register shows the peak over half a second: about 1 s in all
_DECAY_S = 0.17
_WINDOW_S = 0.5
_FORGOTTEN_S = 30 * _DECAY_S


class Vibration:
    """The envelope of one arm's residual vibration, kicked by each stop of its axes."""

    def __init__(self) -> None:
        self.axes_moving: list[Callable[[], bool]] = []
        self._kicks: list[tuple[float, float]] = []

    def kick(self, axis: str, motion: Motion, counts_per_deg: float) -> None:
        """Add what the stop of an axis excites when its motion ends."""
        time_s = motion.end_s
        acceleration_deg_s2 = motion.acceleration / abs(counts_per_deg)
        recent = [kick for kick in self._kicks if time_s - kick[0] < _FORGOTTEN_S]
        self._kicks = [*recent, (time_s, _URAD_PER_DEG_S2 * acceleration_deg_s2)]

    def settle_urad(self, now: float) -> int:
        """Return what the settle register says: the peak over the last 500 ms."""
        if any(moving() for moving in self.axes_moving):
            return MOVING
        times = self.window(now, (kick_s for kick_s, _ in self._kicks))
        return min(round(max(self._envelope(time_s) for time_s in times)), MOVING - 1)

    @staticmethod
    def window(now: float, kicks_s: Iterable[float]) -> list[float]:
        """Return when the envelope may peak: from the window's start or a kick on it falls."""
        begin = now - _WINDOW_S
        return [begin, *(kick_s for kick_s in kicks_s if begin < kick_s <= now)]

    def _envelope(self, time_s: float) -> float:
        return sum(
            strength * math.exp((kick_s - time_s) / _DECAY_S)
            for kick_s, strength in self._kicks
            if kick_s <= time_s
        )
