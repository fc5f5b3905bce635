"""A serial line in process with faults between its two ends."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Final

from gonio.errors import TransportLostError, TransportTimeoutError
from sim.faults.frames import doubled, dropped, flipped

if TYPE_CHECKING:
    from gonio.clock import Clock
    from gonio.transports import SerialLine
    from sim.faults.document import Fault
    from sim.faults.injector import Injector

SPOIL: Final = {
    "line bytes garbled": flipped, "line bytes dropped": dropped, "line bytes doubled": doubled
}  # fmt: skip
"""What becomes of a request or an answer that is not lost."""

EITHER_WAY: Final = (*SPOIL, "line time-out")
"""What may strike a request as well as its answer."""


class FaultyLine:
    """A `gonio.transports.SerialLine` around another one (parameters as for `FaultyBus`)."""

    def __init__(self, line: SerialLine, clock: Clock, injector: Injector) -> None:
        self._line = line
        self._clock = clock
        self._injector = injector
        self._on_answer: Fault | None = None
        self._early: deque[bytes] = deque()
        self._gone_until_s = 0.0

    def send(self, line: bytes) -> None:
        """Send a line (see `gonio.transports.SerialLine`)."""
        fault = self._injector.strike("line", "request")
        if fault is not None and fault.kind == "serial port unplugged":
            self._gone_until_s = self._clock.now() + fault.duration_s
        self._check_there()
        out = (
            fault is not None and fault.kind in EITHER_WAY and self._injector.random.random() < 0.5
        )
        self._on_answer = None if out else fault
        if fault is None or not out:
            self._line.send(line)
        elif fault.kind in SPOIL:
            self._line.send(SPOIL[fault.kind](line, self._injector.random))

    def receive(self, timeout_s: float) -> bytes:
        """Return the next answer (see `gonio.transports.SerialLine`)."""
        self._check_there()
        if self._early:
            return self._early.popleft()
        answer = self._line.receive(timeout_s)
        fault, self._on_answer = self._on_answer, None
        if fault is None or fault.kind == "serial port unplugged":
            return answer
        if fault.kind in SPOIL:
            return SPOIL[fault.kind](answer, self._injector.random)
        if fault.kind != "line time-out":  # the answer comes once more, or too late
            self._early.append(answer)
        if fault.kind == "line answer doubled":
            return answer
        self._clock.sleep(timeout_s)
        raise TransportTimeoutError(
            f"lamps: no answer within {timeout_s:g} s; check cable and device in the rig file"
        )

    def close(self) -> None:
        """Let go of the port."""
        self._line.close()

    def _check_there(self) -> None:
        if self._clock.now() < self._gone_until_s:
            raise TransportLostError("lamps: the serial port is gone; plug it in again")
