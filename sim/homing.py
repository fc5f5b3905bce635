"""Homing mode: find the home switch's edge and count from there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim.positioning import HALT, NEW_SET_POINT, TARGET_REACHED

if TYPE_CHECKING:
    from gonio.rig import Axis
    from sim.axis import AxisMechanics

ATTAINED, FAILED = 0x1000, 0x2000

# set in the drive: half speed to just past the edge, then back to it at a crawl
_SEARCH_SHARE = 0.5
_CRAWL_SHARE = 0.025
_PAST_EDGE_DEG = 0.2


class Homing:
    """The two legs of a homing and its outcome.

    Attributes
    ----------
    attained
        Whether the position is known.
    switch_works
        Set False to let a homing run past the edge into the limit switch and fail.
    """

    def __init__(self, axis: AxisMechanics, spec: Axis) -> None:
        self.attained = False
        self.switch_works = True
        self._axis = axis
        self._velocity = spec.max_velocity_deg_s * axis.counts_per_deg
        self._acceleration = spec.max_acceleration_deg_s2 * axis.counts_per_deg
        self._failed = False
        self._leg = 0

    @property
    def running(self) -> bool:
        """Whether a homing is under way."""
        return self._leg > 0

    def command(self, word: int, rising: int, now: float) -> None:
        """Act on a controlword; `rising` are the bits that it sets newly."""
        if self.running and (word & HALT or not word & NEW_SET_POINT):
            self.interrupt()
            self._axis.stop(now)
        elif rising & NEW_SET_POINT and not word & HALT:
            self._begin(now)

    def arrived(self, now: float) -> None:
        """Go on with the next leg, or finish."""
        if self._leg == 1 and self.switch_works:
            self._leg = 2
            self._axis.go(now, 0.0, _CRAWL_SHARE * self._velocity, self._acceleration)
        elif self._leg == 1:
            self._leg, self._failed = 0, True
        elif self._leg == 2:
            self._leg, self.attained = 0, True
            self._axis.zero_at_edge()

    def interrupt(self) -> None:
        """Give up a homing under way."""
        self._leg = 0

    def forget(self) -> None:
        """Be as at power-up."""
        self.attained = self._failed = False
        self._leg = 0

    def status(self) -> int:
        """Return bits 10, 12 and 13 of the statusword."""
        if self.running:
            return 0
        if self._failed:
            return FAILED
        return TARGET_REACHED | (ATTAINED if self.attained else 0)

    def _begin(self, now: float) -> None:
        self.attained = self._failed = False
        self._leg = 1
        side = self._axis.home_side
        past_edge = side * _PAST_EDGE_DEG * self._axis.counts_per_deg
        low, high = self._axis.limits
        target = past_edge if self.switch_works else (low if side < 0 else high)
        self._axis.go(now, target, _SEARCH_SHARE * self._velocity, self._acceleration)
