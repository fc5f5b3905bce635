"""The lamp head's line, cut out of what arrives at a serial port."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.errors import TransportTimeoutError

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.transports import SerialLine

# far beyond the longest request, and still no place to pour garbage into
_KEPT_BYTES = 1024


class LampPort:
    """Answers each line that ends in LF with one that ends in CR LF.

    Parameters
    ----------
    line
        To the lamp head.
    send
        Takes what goes back.
    """

    def __init__(self, line: SerialLine, send: Callable[[bytes], None]) -> None:
        self._line, self._send = line, send
        self._begun = b""

    def receive(self, data: bytes) -> None:
        """Take in bytes and answer every line that is whole by now, in order."""
        *requests, begun = (self._begun + data).split(b"\n")
        self._begun = begun[:_KEPT_BYTES]
        for request in requests:
            self._line.send(request)
            try:
                self._send(self._line.receive(0.0) + b"\r\n")
            except TransportTimeoutError:
                continue
