"""The serial line to the lamp head, behind the transport seam."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from gonio.errors import TransportTimeoutError

if TYPE_CHECKING:
    from gonio.clock import Clock
    from sim.lamp_protocol import LampProtocol

BYTE_S = 1.0 / 11520.0
"""What a byte takes at 115200 8N1."""


class TwinLine:
    """A `gonio.transports.SerialLine` with a simulated lamp head at its other end."""

    def __init__(self, protocol: LampProtocol, clock: Clock) -> None:
        self._protocol = protocol
        self._clock = clock
        self._answers: deque[bytes] = deque()

    def send(self, line: bytes) -> None:
        """Send a line (see `gonio.transports.SerialLine`)."""
        for request in line.split(b"\n"):
            self._clock.sleep(BYTE_S * (len(request) + 1))
            self._answers.append(self._protocol.answer(request))

    def receive(self, timeout_s: float) -> bytes:
        """Return the next answer (see `gonio.transports.SerialLine`)."""
        if not self._answers:
            self._clock.sleep(timeout_s)
            raise TransportTimeoutError(
                f"lamps: no answer within {timeout_s:g} s; check cable and device in the rig file"
            )
        answer = self._answers.popleft()
        self._clock.sleep(BYTE_S * (len(answer) + 2))
        return answer

    def close(self) -> None:
        """Let go of the port."""
