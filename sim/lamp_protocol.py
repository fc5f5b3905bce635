"""The lamp head's line protocol: one line in, one line out."""

from __future__ import annotations

import re
from functools import reduce
from operator import xor
from typing import TYPE_CHECKING

from sim.lamp_head import (
    BAD_CHECKSUM,
    CAMERA_BUSY,
    INTERLOCK_OPEN,
    OPEN_CIRCUIT,
    OUT_OF_RANGE,
    OVER_TEMPERATURE,
    OVERFLOW,
    UNKNOWN,
    LampError,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from sim.lamp_head import LampHead

IDENTITY = "gonio,simulated lamp head,0001,1.0"

_MAX_BYTES = 120
_NUMBER = re.compile(rb"#\d{1,2} ")
_CHECKSUM = re.compile(rb"\*[0-9A-Fa-f]{2}\Z")
_LAMP = re.compile(r"LED(\d+):(CURR|STAT|TEMP|FLUX)(\?|)")
_CURRENT = re.compile(r"-?\d+(\.\d)?")
_INTEGER = re.compile(r"-?\d+")

_TEXTS = {
    0: "No error",
    UNKNOWN: "Unknown command",
    BAD_CHECKSUM: "Bad checksum",
    OUT_OF_RANGE: "Number out of range",
    OVER_TEMPERATURE: "Lamp over-temperature",
    OPEN_CIRCUIT: "Lamp open circuit",
    OVERFLOW: "Queue overflow",
    INTERLOCK_OPEN: "Interlock open",
    CAMERA_BUSY: "Camera busy",
}


class LampProtocol:
    """Reads requests to a lamp head and words its answers."""

    def __init__(self, head: LampHead) -> None:
        self._head = head
        self._plain: dict[str, Callable[[], str]] = {
            "*IDN?": lambda: IDENTITY,
            "ALL:OFF": self._all_off,
            "TRIG:STAT?": lambda: head.shutter.status,
            "TRIG:ABRT": self._abort,
            "SYST:ERR?": lambda: _error_text(head.next_error()),
        }
        self._with_number: dict[str, Callable[[int], str]] = {
            "TRIG:EXP": lambda us: f"OK {head.expose(us)}",
            "SYST:WDOG": self._watchdog,
        }
        self._queries: dict[str, Callable[[int], str]] = {
            "CURR": lambda n: f"{head.led(n).current_mA:.1f}",
            "STAT": lambda n: str(int(head.led(n).on)),
            "TEMP": lambda n: f"{head.temperature_c(n):.1f}",
            "FLUX": lambda n: f"{head.flux(n):.5f}",
        }

    def answer(self, line: bytes) -> bytes:
        """Return the answer to a request, both without the line feed and what precedes it.

        Parameters
        ----------
        line
            As received up to the line feed, a carriage return at its end included.
        """
        self._head.advance()
        request = line.removesuffix(b"\r")
        number, body, checksum = _split(request)
        try:
            if len(line) + 1 > _MAX_BYTES:
                raise LampError(UNKNOWN)
            if checksum and int(checksum[1:], 16) != _xor(request[:-3]):
                raise LampError(BAD_CHECKSUM)
            text = self._act(body)
            self._head.asked()
        except LampError as error:
            self._head.queue(error.code)
            text = f"ERR {_error_text(error.code)}"
        answer = number + text.encode("ascii")
        return answer + b"*%02X" % _xor(answer) if checksum else answer

    def _act(self, body: bytes) -> str:
        if not body.isascii():
            raise LampError(UNKNOWN)
        name, space, argument = body.decode("ascii").partition(" ")
        lamp = _LAMP.fullmatch(name)
        if lamp:
            return self._ask_lamp(int(lamp[1]), lamp[2], bool(lamp[3]), argument, bool(space))
        if name in self._plain and not space:
            return self._plain[name]()
        if name in self._with_number and _INTEGER.fullmatch(argument):
            return self._with_number[name](int(argument))
        raise LampError(UNKNOWN)

    def _ask_lamp(
        self, n: int, what: str, is_query: bool, argument: str, has_argument: bool
    ) -> str:
        if is_query and not has_argument:
            return self._queries[what](n)
        if not is_query and what == "CURR" and _CURRENT.fullmatch(argument):
            self._head.set_current(n, float(argument))
        elif not is_query and what == "STAT" and argument in ("ON", "OFF"):
            self._head.switch(n, argument == "ON")
        else:
            raise LampError(UNKNOWN)
        return "OK"

    def _all_off(self) -> str:
        self._head.all_off()
        return "OK"

    def _abort(self) -> str:
        self._head.shutter.abort()
        return "OK"

    def _watchdog(self, milliseconds: int) -> str:
        self._head.set_watchdog(milliseconds)
        return "OK"


def _split(request: bytes) -> tuple[bytes, bytes, bytes]:
    """Return number, command and checksum of a request, each with its marks or empty."""
    number = _NUMBER.match(request)
    start = number.end() if number else 0
    checksum = _CHECKSUM.search(request, start)
    end = checksum.start() if checksum else len(request)
    return request[:start], request[start:end], request[end:]


def _error_text(code: int) -> str:
    return f'{code},"{_TEXTS[code]}"'


def _xor(data: bytes) -> int:
    return reduce(xor, data, 0)
