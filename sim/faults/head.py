"""A lamp head whose camera is busy, and in front of which things happen while it exposes."""

from __future__ import annotations

import re
from collections import deque
from functools import reduce
from operator import xor
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gonio.clock import Clock
    from gonio.transports import SerialLine
    from sim.faults.injector import Injector
    from sim.faults.mishaps import Mishaps

_EXPOSURE = re.compile(rb"(?:#(\d+) )?TRIG:EXP ")


class FaultyHead:
    """A `gonio.transports.SerialLine` around another one, at the head's end of the wire.

    Parameters
    ----------
    line
        The line.
    clock
        On which a camera is busy.
    injector
        Says what strikes.
    mishaps
        Told of every exposure.
    """

    def __init__(
        self, line: SerialLine, clock: Clock, injector: Injector, mishaps: Mishaps
    ) -> None:
        self._line = line
        self._clock = clock
        self._injector = injector
        self._mishaps = mishaps
        self._refusals: deque[bytes] = deque()
        self._busy_until_s = 0.0

    def send(self, line: bytes) -> None:
        """Send a line (see `gonio.transports.SerialLine`)."""
        exposing = _EXPOSURE.match(line)
        if exposing and self._camera_is_busy():
            self._refusals.append(_busy(exposing[1]))
            return
        if exposing:
            self._mishaps.exposed()
        self._line.send(line)

    def receive(self, timeout_s: float) -> bytes:
        """Return the next answer (see `gonio.transports.SerialLine`)."""
        return self._refusals.popleft() if self._refusals else self._line.receive(timeout_s)

    def close(self) -> None:
        """Let go of the port."""
        self._line.close()

    def _camera_is_busy(self) -> bool:
        fault = self._injector.strike("camera", "exposure")
        if fault is not None:
            self._busy_until_s = self._clock.now() + fault.duration_s
        return self._clock.now() < self._busy_until_s


def _busy(number: bytes | None) -> bytes:
    text = (b"#%s " % number if number else b"") + b'ERR 500,"Camera busy"'
    return text + b"*%02X" % reduce(xor, text)
