"""Profile position mode: set-points, their handshake, and halt."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.axis import AxisMechanics

NEW_SET_POINT, CHANGE_IMMEDIATELY, HALT = 0x0010, 0x0020, 0x0100
TARGET_REACHED, ACKNOWLEDGED = 0x0400, 0x1000


@dataclass(frozen=True)
class SetPoint:
    """Where to go, in counts, and how: what the registers held when it was given."""

    target: int
    velocity: int
    acceleration: int


class Positioning:
    """The set-point under way, one more behind it, and what the statusword says of them.

    Attributes
    ----------
    active
        The set-point under way, or None.
    refused
        Whether the last set-point offered was refused.
    """

    def __init__(self, axis: AxisMechanics) -> None:
        self.active: SetPoint | None = None
        self.refused = False
        self._axis = axis
        self._buffered: SetPoint | None = None
        self._acknowledged = False
        self._controlword = 0

    def command(self, word: int, rising: int, point: SetPoint, homed: bool, now: float) -> None:
        """Act on a controlword; `rising` are the bits that it sets newly."""
        was_halted, active = self._halted, self.active
        self._controlword = word
        if rising & NEW_SET_POINT:
            self._offer(point, homed=homed, immediately=bool(word & CHANGE_IMMEDIATELY))
        self._release_acknowledge()
        if self._halted and not was_halted:
            self._axis.stop(now)
        elif not self._halted and (was_halted or self.active is not active):
            self._start(now)

    def arrived(self, now: float) -> None:
        """Go on with the buffered set-point, unless what ended is a halt."""
        if not self._halted:
            self.active, self._buffered = self._buffered, None
            self._release_acknowledge()
            self._start(now)

    def begin(self, word: int) -> None:
        """Start afresh in *operation enabled*."""
        self._controlword = word

    def give_up(self) -> None:
        """Forget every set-point."""
        self.active = self._buffered = None
        self._acknowledged = False
        self._controlword = 0

    def status(self) -> int:
        """Return bits 10 and 12 of the statusword."""
        arrived = not self._axis.moving and (self._halted or self.active is None)
        return (TARGET_REACHED if arrived else 0) | (ACKNOWLEDGED if self._acknowledged else 0)

    @property
    def _halted(self) -> bool:
        return bool(self._controlword & HALT)

    def _offer(self, point: SetPoint, *, homed: bool, immediately: bool) -> None:
        low, high = self._axis.travel
        acceptable = homed and low <= point.target <= high
        if acceptable and (immediately or self.active is None):
            self.active, self._buffered = point, None
        elif acceptable and self._buffered is None:
            self._buffered = point
        else:
            acceptable = False
        self._acknowledged = acceptable
        self.refused = not acceptable

    def _release_acknowledge(self) -> None:
        if not self._controlword & NEW_SET_POINT and self._buffered is None:
            self._acknowledged = False

    def _start(self, now: float) -> None:
        if self.active is not None:
            point = self.active
            self._axis.go(now, point.target, point.velocity, point.acceleration)
