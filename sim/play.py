"""Backlash and friction: how a load trails what drives it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.motion import Motion


class Play:
    """The play operator (Krasnosel'skii and Pokrovskii, Systems with Hysteresis, 1989).

    The load stays where it is until what drives it is half the play ahead, and then follows. A load
    that a servo pulls over dry friction by its stiffness does the same.

    Parameters
    ----------
    half
        How far the load may trail, in counts.
    position
        Where it is, in counts.
    """

    def __init__(self, half: float, position: float) -> None:
        self._half = half
        self._load = position

    def load(self, motion: Motion, now: float) -> float:
        """Return where a motion has taken the load by `now`; motions turn only between pieces."""
        load = self._load
        for piece in motion.pieces:
            if motion.start_s + piece.start_s <= now:
                load = self._dragged(load, piece.position)
        return self._dragged(load, motion.at(now)[0])

    def settle(self, position: float) -> None:
        """Go on from a position."""
        self._load = position

    def _dragged(self, load: float, driven: float) -> float:
        return min(max(load, driven - self._half), driven + self._half)
