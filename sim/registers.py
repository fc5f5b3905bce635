"""The register table of the twin's drives, and the checks that a request passes before it acts.

Written from the protocol page, not from the profile that the drivers read: two readings of one
page find each other's slips.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

ILLEGAL_ADDRESS = 0x02
ILLEGAL_VALUE = 0x03
NO_SUCH_UNIT = 0x0B

_MAX_READ, _MAX_WRITE = 125, 123


class RefusedError(Exception):
    """A request that is answered with a Modbus exception."""

    def __init__(self, code: int) -> None:
        super().__init__(f"exception {code}")
        self.code = code


@dataclass(frozen=True)
class Register:
    """One object in one or two 16-bit registers, the high word first."""

    address: int
    name: str
    words: int = 1
    writable: bool = False
    signed: bool = False
    least: int = 0
    allowed: frozenset[int] | None = None

    def value(self, words: Sequence[int]) -> int:
        """Put the words together.

        Raises
        ------
        RefusedError
            When the value is out of range.
        """
        value = int.from_bytes(
            b"".join(word.to_bytes(2, "big") for word in words), "big", signed=self.signed
        )
        if not self.signed and value < self.least:
            raise RefusedError(ILLEGAL_VALUE)
        if self.allowed is not None and value not in self.allowed:
            raise RefusedError(ILLEGAL_VALUE)
        return value


_TABLE = (
    Register(0x0000, "controlword", writable=True),
    Register(0x0001, "statusword"),
    Register(0x0002, "mode", writable=True, allowed=frozenset({1, 6})),
    Register(0x0003, "mode_display"),
    Register(0x0004, "target_position", words=2, writable=True, signed=True),
    Register(0x0006, "position_actual", words=2, signed=True),
    Register(0x0008, "profile_velocity", words=2, writable=True),
    Register(0x000A, "profile_acceleration", words=2, writable=True, least=1),
    Register(0x000C, "following_error", words=2, signed=True),
    Register(0x000E, "error_code"),
    Register(0x000F, "digital_inputs"),
    Register(0x0010, "watchdog_ms", writable=True),
    Register(0x0011, "settle_urad"),
)
_AT = {register.address + word: register for register in _TABLE for word in range(register.words)}


@lru_cache
def read_span(address: int, count: int) -> tuple[tuple[str, int], ...]:
    """Return name and right shift of each word that a read asks for.

    Raises
    ------
    RefusedError
        When the read may not be answered.
    """
    registers = _span(address, count, _MAX_READ)
    last_words = [register.address + register.words - 1 for register in registers]
    return tuple(
        (register.name, 16 * (last - word))
        for word, (register, last) in enumerate(zip(registers, last_words, strict=True), address)
    )


def check_write(address: int, values: Sequence[int]) -> list[tuple[str, int]]:
    """Return name and value of each object that a write sets.

    Raises
    ------
    RefusedError
        When any part of it may not be written: quantity first, then address, then value.
    """
    registers = _span(address, len(values), _MAX_WRITE)
    if not all(register.writable for register in registers):
        raise RefusedError(ILLEGAL_ADDRESS)
    first, last = registers[0], registers[-1]
    if first.address != address or last.address + last.words != address + len(values):
        raise RefusedError(ILLEGAL_VALUE)
    writes = []
    for register in dict.fromkeys(registers):
        start = register.address - address
        writes.append((register.name, register.value(values[start : start + register.words])))
    return writes


def _span(address: int, count: int, most: int) -> list[Register]:
    """Return the register behind each word of a request."""
    if not 1 <= count <= most:
        raise RefusedError(ILLEGAL_VALUE)
    registers = [_AT.get(word) for word in range(address, address + count)]
    found = [register for register in registers if register is not None]
    if len(found) < count:
        raise RefusedError(ILLEGAL_ADDRESS)
    return found
