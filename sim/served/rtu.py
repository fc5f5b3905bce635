"""Modbus RTU: unit id, request and CRC-16, told apart by length and by silence."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from pymodbus.framer import FramerRTU

if TYPE_CHECKING:
    from collections.abc import Callable

SILENCE_S = 0.02
"""What ends a frame; the standard's 1.75 ms are too short for the scheduler of a busy machine."""

_LEAST_BYTES, _MOST_BYTES = 4, 256


class RtuLine:
    """Finds the requests in what arrives at a serial port.

    Whoever finds no request in what came before a silence says nothing, as the standard has it.

    Parameters
    ----------
    answer
        Returns the reply to (unit, request), or None for silence.
    send
        Takes what goes back.
    """

    def __init__(
        self, answer: Callable[[int, bytes], bytes | None], send: Callable[[bytes], None]
    ) -> None:
        self._answer, self._send = answer, send
        self._received = b""
        self._silence: asyncio.TimerHandle | None = None

    def receive(self, data: bytes) -> None:
        """Take in bytes; a request whose function tells its length is answered at once."""
        self._received = (self._received + data)[: 2 * _MOST_BYTES]
        while (size := _size(self._received)) and _is_whole(self._received[:size]):
            frame, self._received = self._received[:size], self._received[size:]
            self._reply(frame)
        if self._silence is not None:
            self._silence.cancel()
        self._silence = asyncio.get_running_loop().call_later(SILENCE_S, self._after_silence)

    def _after_silence(self) -> None:
        frame, self._received = self._received, b""
        if _is_whole(frame):
            self._reply(frame)

    def _reply(self, frame: bytes) -> None:
        reply = self._answer(frame[0], frame[1:-2])
        if reply is not None:
            self._send(frame[:1] + reply + _crc(frame[:1] + reply))


def _size(received: bytes) -> int:
    """Return the length of the request that these bytes begin; 0 where it is not known yet."""
    function = received[1] if len(received) > 1 else 0
    if function in (3, 6):
        return 8
    return received[6] + 9 if function == 16 and len(received) > 6 else 0


def _is_whole(frame: bytes) -> bool:
    return len(frame) >= _LEAST_BYTES and frame[-2:] == _crc(frame[:-2])


def _crc(data: bytes) -> bytes:
    # an int that pymodbus has already swapped: low byte first on the wire
    return FramerRTU.compute_CRC(data).to_bytes(2, "big")
