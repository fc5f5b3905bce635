"""Modbus TCP: each request behind a header with its transaction id."""

from __future__ import annotations

import asyncio
import struct
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from collections.abc import Callable

_HEADER = struct.Struct(">HHHB")
# the length counts the unit id; a request has at least a function code, and at most 253 bytes
_LENGTHS = range(2, 255)


class TcpClient(asyncio.Protocol):
    """The connection of one client.

    Parameters
    ----------
    answer
        Returns the reply to (unit, request), or None for silence.
    send
        Is given what writes to the client, and the frame to write.
    """

    def __init__(
        self,
        answer: Callable[[int, bytes], bytes | None],
        send: Callable[[Callable[[bytes], None], bytes], None],
    ) -> None:
        self._answer, self._send = answer, send
        self._received = b""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Keep the way back."""
        self._transport = cast("asyncio.Transport", transport)

    def data_received(self, data: bytes) -> None:
        """Answer every request that is whole by now, in order."""
        self._received += data
        while len(self._received) >= _HEADER.size:
            transaction, protocol, length, unit = _HEADER.unpack_from(self._received)
            if length not in _LENGTHS:
                # where the next request begins can no longer be known
                self._transport.abort()
                return
            end = _HEADER.size - 1 + length
            if len(self._received) < end:
                return
            request, self._received = self._received[_HEADER.size : end], self._received[end:]
            reply = self._answer(unit, request) if protocol == 0 else None
            if reply is not None:
                header = _HEADER.pack(transaction, 0, len(reply) + 1, unit)
                self._send(self._transport.write, header + reply)
