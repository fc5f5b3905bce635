"""Drives that answer what is no longer so, and arms to which things happen when they move."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from gonio.transports import RegisterBus
    from sim.faults.injector import Injector
    from sim.faults.mishaps import Mishaps

_CONTROLWORD, _POSITION, _NEW_SET_POINT = 0x0000, 0x0006, 0x0010
# bit 19 of the encoder's count: 262 deg at 2000 counts/deg
_GLITCH = 0x0008


class FaultyDrives:
    """A `gonio.transports.RegisterBus` around another one, at the drives' end of the wire.

    Parameters
    ----------
    bus
        The bus.
    axes
        Name of the axis of each unit.
    injector
        Says what strikes.
    mishaps
        Told of every move.
    """

    def __init__(
        self, bus: RegisterBus, axes: Mapping[int, str], injector: Injector, mishaps: Mishaps
    ) -> None:
        self._bus = bus
        self._axes = axes
        self._injector = injector
        self._mishaps = mishaps
        self._read_before: dict[tuple[int, int, int], list[int]] = {}

    def read(self, unit: int, address: int, count: int) -> list[int]:
        """Read registers (see `gonio.transports.RegisterBus`)."""
        words = self._bus.read(unit, address, count)
        key, axis = (unit, address, count), self._axes.get(unit)
        if self._injector.strike("bus", "read", axis):
            words = self._read_before.get(key, words)
        self._read_before[key] = words
        if address == _POSITION and self._injector.strike("bus", "reading of an angle", axis):
            return [words[0] ^ _GLITCH, *words[1:]]
        return words

    def write(self, unit: int, address: int, values: Sequence[int]) -> None:
        """Write registers (see `gonio.transports.RegisterBus`)."""
        self._bus.write(unit, address, values)
        if address == _CONTROLWORD and values[0] & _NEW_SET_POINT and unit in self._axes:
            self._mishaps.moved(self._axes[unit])

    def close(self) -> None:
        """Let go of the bus."""
        self._bus.close()
