"""A drive's registers by name, whatever addresses its profile gives them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.devices.patience import Patience
from gonio.errors import DeviceFaultError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.clock import Clock
    from gonio.devices.troubles import Troubles
    from gonio.profiles import Profile, Register
    from gonio.transports import RegisterBus


def to_words(value: int, count: int) -> list[int]:
    """Split a value, negative ones in two's complement, into 16-bit words, the high one first."""
    return [value >> 16 * place & 0xFFFF for place in reversed(range(count))]


def from_words(words: Sequence[int], *, signed: bool) -> int:
    """Put 16-bit words together, the high one first."""
    value = 0
    for word in words:
        value = value << 16 | word
    negative = signed and words[0] & 0x8000
    return value - (1 << 16 * len(words)) if negative else value


class DriveRegisters:
    """The registers of one unit.

    A lost reply says nothing about execution, so a write is read back before it is repeated
    (errors as for `gonio.devices.patience.Patience.ask`).

    Parameters
    ----------
    bus
        The bus.
    unit
        The drive's unit id.
    profile
        Which register holds what.
    clock, troubles
        To wait on, and who is told what was asked again.
    """

    def __init__(
        self, bus: RegisterBus, unit: int, profile: Profile, clock: Clock, troubles: Troubles
    ) -> None:
        self._bus = bus
        self._patience = Patience(clock, troubles)
        self._unit = unit
        self._profile = profile

    def read(self, name: str) -> int:
        """Read an object by its name in the profile."""
        register = self._register(name)
        words = self._patience.ask(lambda: self._words(register))
        return from_words(words, signed=register.type == "int32")

    def write(self, name: str, value: int) -> None:
        """Write an object by its name in the profile."""
        register = self._register(name)
        words = to_words(value, register.words)
        sent = False

        def make_sure() -> None:
            nonlocal sent
            if not sent or self._words(register) != words:
                sent = True
                self._bus.write(self._unit, register.address, words)

        self._patience.ask(make_sure)

    def try_to_write(self, name: str, value: int) -> bool:
        """Write once and return whether that was answered well; nothing is sent again."""
        register = self._register(name)
        try:
            self._bus.write(self._unit, register.address, to_words(value, register.words))
        except DeviceFaultError:
            return False
        return True

    def try_to_read(self, name: str) -> bool:
        """Read once and return whether that was answered; nothing is asked again."""
        try:
            self._words(self._register(name))
        except DeviceFaultError:
            return False
        return True

    def _words(self, register: Register) -> list[int]:
        return self._bus.read(self._unit, register.address, register.words)

    def _register(self, name: str) -> Register:
        register: Register = getattr(self._profile, name)
        return register
