"""Modbus requests and replies without their frames, as TCP and RTU share them.

pymodbus has a server, but it answers a quantity of 0 as an unknown function 0 and a missing unit by
exception 4, and drops RTU requests of functions that it does not know; hence this one.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from gonio.errors import RegisterError, TransportTimeoutError
from sim.registers import ILLEGAL_VALUE, NO_SUCH_UNIT, RefusedError

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.transports import RegisterBus

ILLEGAL_FUNCTION = 0x01


class ModbusUnits:
    """Answers for the units of a bus.

    Parameters
    ----------
    bus
        Behind which they are.
    has
        Tells whether a unit is there.
    answers_for_unknown
        Whether somebody answers for units that are not, as a gateway on TCP does.
    """

    def __init__(
        self, bus: RegisterBus, has: Callable[[int], bool], *, answers_for_unknown: bool
    ) -> None:
        self._bus, self._has = bus, has
        self._answers_for_unknown = answers_for_unknown
        self._functions = {3: self._read, 6: self._write_one, 16: self._write}

    def answer(self, unit: int, request: bytes) -> bytes | None:
        """Return the reply to a request, both from the function code on; None for silence."""
        if not self._has(unit):
            return _refusal(request, NO_SUCH_UNIT) if self._answers_for_unknown else None
        act = self._functions.get(request[0])
        if act is None:
            return _refusal(request, ILLEGAL_FUNCTION)
        try:
            return request[:1] + act(unit, request[1:])
        except (RefusedError, RegisterError) as refused:
            return _refusal(request, refused.code)
        except TransportTimeoutError:
            return None

    def _read(self, unit: int, body: bytes) -> bytes:
        address, count = _unpack(">HH", body)
        words = self._bus.read(unit, address, count)
        return struct.pack(f">B{len(words)}H", 2 * len(words), *words)

    def _write_one(self, unit: int, body: bytes) -> bytes:
        address, value = _unpack(">HH", body)
        self._bus.write(unit, address, [value])
        return body

    def _write(self, unit: int, body: bytes) -> bytes:
        address, count, size = _unpack(">HHB", body[:5])
        if size != 2 * count:
            raise RefusedError(ILLEGAL_VALUE)
        self._bus.write(unit, address, _unpack(f">{count}H", body[5:]))
        return body[:4]


def _unpack(form: str, body: bytes) -> tuple[int, ...]:
    try:
        return struct.unpack(form, body)
    except struct.error:
        raise RefusedError(ILLEGAL_VALUE) from None


def _refusal(request: bytes, code: int) -> bytes:
    return bytes([request[0] | 0x80, code])
