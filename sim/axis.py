"""The moving parts of one axis: motor, load, encoder and switches."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from sim.motion import go, rest, stop
from sim.play import Play

if TYPE_CHECKING:
    from gonio.rig import Axis
    from sim.fittings import Fittings

# the load trails the demand by this much while it moves, as behind any position loop
_LAG_S = 0.002
_SWITCH_MARGIN_DEG = 1.0

_NEGATIVE_LIMIT, _POSITIVE_LIMIT, _HOME_SWITCH = 0x1, 0x2, 0x4


class AxisMechanics:
    """Where an axis truly is; positions are in counts from the home switch's edge.

    Parameters
    ----------
    spec
        Scale and travel.
    fittings
        The arm that it shakes, its gear and its encoder.
    position
        Where it stands at power-up.

    Attributes
    ----------
    end_s
        When the present motion ends; infinite at standstill.
    jammed_at
        Where something holds the load, or None. What drives it goes on.
    """

    def __init__(self, spec: Axis, fittings: Fittings, position: float) -> None:
        self.counts_per_deg = abs(spec.counts_per_deg)
        self.travel = sorted((spec.to_counts(spec.min_deg), spec.to_counts(spec.max_deg)))
        margin = _SWITCH_MARGIN_DEG * self.counts_per_deg
        self.limits = (min(self.travel[0], 0) - margin, max(self.travel[1], 0) + margin)
        self.home_side = -1 if sum(self.travel) > 0 else 1
        self.jammed_at: float | None = None
        self._slipped = 0.0
        self._stuck_switch = 0
        self._spec = spec
        self._fittings = fittings
        self._play = Play(fittings.half_play, position)
        self._encoder_zero = position
        self._motion = rest(position)
        self.end_s = math.inf
        fittings.vibration.axes_moving.append(lambda: self.moving)

    @property
    def moving(self) -> bool:
        """Whether a motion is under way."""
        return self.end_s < math.inf

    def actual(self, now: float) -> float:
        """Return where the load is."""
        if self.jammed_at is not None:
            return self.jammed_at
        _, velocity = self._motion.at(now)
        return self._play.load(self._motion, now) - self._slipped - _LAG_S * velocity

    def actual_deg(self, now: float) -> float:
        """Return the axis' true angle in degrees."""
        return (self.actual(now) - self._spec.zero_counts) / self._spec.counts_per_deg

    def encoder(self, now: float) -> int:
        """Return what the encoder counts."""
        return self._fittings.encoder.count(self.actual(now) - self._encoder_zero, now)

    def following_error(self, now: float) -> int:
        """Return demand - actual, in whole counts."""
        demand, _ = self._motion.at(now)
        return round(demand - self._encoder_zero) - self.encoder(now)

    def inputs(self, now: float) -> int:
        """Return the bits of the two limit switches and the home switch."""
        position = self.actual(now)
        low, high = self.limits
        bits = _NEGATIVE_LIMIT if position <= low else 0
        bits |= _POSITIVE_LIMIT if position >= high else 0
        bits |= self._stuck_switch
        return bits | (_HOME_SWITCH if position * self.home_side >= 0 else 0)

    def go(self, now: float, target: float, velocity: float, acceleration: float) -> None:
        """Move to `target` from wherever the axis is and however it moves."""
        self._play.settle(self._play.load(self._motion, now))
        self._motion = go(now, *self._motion.at(now), target, velocity, acceleration)
        self.end_s = self._motion.end_s

    def stop(self, now: float) -> None:
        """Come to rest on a ramp."""
        if self.moving:
            self._play.settle(self._play.load(self._motion, now))
            self._motion = stop(now, *self._motion.at(now), self._motion.acceleration)
            self.end_s = self._motion.end_s

    def finish(self) -> None:
        """End the present motion where it ends, which shakes the arm."""
        if self._motion.pieces:
            scale = self._spec.counts_per_deg
            self._fittings.vibration.kick(self._fittings.name, self._motion, scale)
        self._play.settle(self._play.load(self._motion, self.end_s))
        self._motion = rest(self._motion.end)
        self.end_s = math.inf

    def let_go(self, now: float) -> None:
        """Cut the power: a load that something holds stays, and nothing pushes it any more."""
        self._motion = rest(self.actual(now))
        self._play.settle(self._motion.end)
        self._slipped = 0.0
        self.end_s = math.inf

    def jam(self, now: float) -> None:
        """Hold the load where it is."""
        self.jammed_at = self.actual(now)

    def free(self) -> None:
        """Let go of a load that was held."""
        self.jammed_at = None

    def slip(self, degrees: float) -> None:
        """Let the load fall behind what drives it, for as long as that stays powered."""
        self._slipped += degrees * self.counts_per_deg

    def close_switch(self, now: float) -> None:
        """Let the limit switch ahead say that it is reached, until `open_switch`."""
        _, velocity = self._motion.at(now)
        self._stuck_switch = _NEGATIVE_LIMIT if velocity < 0 else _POSITIVE_LIMIT

    def open_switch(self) -> None:
        """Let the limit switches say what is."""
        self._stuck_switch = 0

    def lose_position(self, now: float) -> None:
        """Count from here, as an encoder does that was just switched on."""
        self._encoder_zero = self.actual(now)

    def zero_at_edge(self) -> None:
        """Count from the home switch's edge."""
        self._encoder_zero = 0.0
