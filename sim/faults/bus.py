"""A bus in process with faults between its two ends."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from gonio.errors import RegisterError, TransportTimeoutError
from sim.faults.frames import doubled, dropped, flipped, is_intact, sealed

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from gonio.clock import Clock
    from gonio.transports import RegisterBus
    from sim.faults.document import Fault
    from sim.faults.injector import Injector

_REPLY_TIMEOUT_S = 0.5
_BUSY = 6

_SPOIL = {"bus CRC error": flipped, "bus bytes dropped": dropped, "bus bytes doubled": doubled}


class FaultyBus:
    """A `gonio.transports.RegisterBus` around another one.

    Parameters
    ----------
    bus
        The bus.
    axes
        Name of the axis of each unit.
    clock
        On which time-outs take their time.
    injector
        Says what strikes.
    """

    def __init__(
        self, bus: RegisterBus, axes: Mapping[int, str], clock: Clock, injector: Injector
    ) -> None:
        self._bus = bus
        self._axes = axes
        self._clock = clock
        self._injector = injector

    def read(self, unit: int, address: int, count: int) -> list[int]:
        """Read registers (see `gonio.transports.RegisterBus`)."""
        request = struct.pack(">BBHH", unit, 3, address, count)
        return self._through(
            unit, address, request, lambda: self._bus.read(unit, address, count), count
        )

    def write(self, unit: int, address: int, values: Sequence[int]) -> None:
        """Write registers (see `gonio.transports.RegisterBus`)."""
        words = struct.pack(f">{len(values)}H", *values)
        request = struct.pack(">BBHHB", unit, 16, address, len(values), len(words)) + words

        def carry_out() -> list[int]:
            self._bus.write(unit, address, values)
            return []

        self._through(unit, address, request, carry_out, 0)

    def close(self) -> None:
        """Let go of the bus."""
        self._bus.close()

    def _through(
        self,
        unit: int,
        address: int,
        request: bytes,
        carry_out: Callable[[], list[int]],
        count: int,
    ) -> list[int]:
        """Let a request travel there and its reply back, or let either be lost."""
        fault = self._injector.strike("bus", "request", self._axes.get(unit))
        if fault is None:
            return carry_out()
        if fault.kind == "bus exception reply":
            raise RegisterError(unit, address, _BUSY)
        out = bool(self._injector.random.random() < 0.5) and fault.kind in (*_SPOIL, "bus time-out")
        if out and not self._arrives(fault, request):
            raise self._lost(unit)
        words = carry_out()
        reply = struct.pack(f">BBB{count}H", unit, 3 if count else 16, 2 * count, *words)
        if not out and not self._arrives(fault, reply):
            raise self._lost(unit)
        return words

    def _arrives(self, fault: Fault, content: bytes) -> bool:
        """Return whether what the fault leaves of a frame is taken by who receives it."""
        spoil = _SPOIL.get(fault.kind)
        return spoil is not None and is_intact(spoil(sealed(content), self._injector.random))

    def _lost(self, unit: int) -> TransportTimeoutError:
        self._clock.sleep(_REPLY_TIMEOUT_S)
        return TransportTimeoutError(
            f"unit {unit}: no reply within {_REPLY_TIMEOUT_S:g} s; check the unit in the rig file"
        )
