"""The camera's shutter: opened by a trigger, closed by time, with the light that came through."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from gonio.clock import VirtualClock
    from sim.led import Led
    from sim.tether import Scene, Tether


class Shutter:
    """One exposure at a time, numbered from 1 since power-up.

    Parameters
    ----------
    clock
        On which exposures end.
    tether
        The camera behind it.
    leds
        Whose light it measures.

    Attributes
    ----------
    closes_s
        When the open shutter closes; infinite when it is closed.
    status
        What TRIG:STAT? answers.
    """

    def __init__(self, clock: VirtualClock, tether: Tether, leds: Sequence[Led]) -> None:
        self.closes_s = math.inf
        self.status = "IDLE"
        self._clock = clock
        self._tether = tether
        self._leds = leds
        self._frame = 0
        self._opened_s = 0.0
        self._doses_s: list[float] = []
        self._junctions_c = np.zeros(0)

    def open(self, exposure_us: int, scene: Scene, on_time: Callable[[], None]) -> int:
        """Open it, have `on_time` called when it is to close, and return the frame's number."""
        self._frame += 1
        self._opened_s = self._clock.now()
        self.closes_s = self._opened_s + exposure_us / 1e6
        self._doses_s = [led.dose_s(self._opened_s) for led in self._leds]
        self._junctions_c = self._temperatures_c(self._opened_s)
        self.status = f"OPEN {self._frame}"
        self._clock.call_at(self.closes_s, on_time)
        self._tether.opened(self._frame, exposure_us / 1e6, scene)
        return self._frame

    def close(self) -> None:
        """Close it when it is time: the mean flux is exact, whatever the lamps did meanwhile."""
        closes_s, self.closes_s = self.closes_s, math.inf
        doses_s = [led.dose_s(closes_s) for led in self._leds]
        flux = (np.array(doses_s) - self._doses_s) / (closes_s - self._opened_s)
        self.status = f"DONE {self._frame} " + ",".join(f"{value:.5f}" for value in flux)
        # between its ends a junction's temperature is nearly a line
        junctions_c = (self._junctions_c + self._temperatures_c(closes_s)) / 2.0
        self._tether.closed(flux, junctions_c)

    def abort(self) -> None:
        """Close it, if it is open, for no frame."""
        if self.closes_s < math.inf:
            self.closes_s = math.inf
            self.status = "IDLE"
            self._tether.aborted()

    def _temperatures_c(self, now: float) -> NDArray[np.float64]:
        return np.array([led.temperature_c(now) for led in self._leds])
