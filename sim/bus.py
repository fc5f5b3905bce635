"""The bus that the drives hang on, behind the transport seam."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.errors import RegisterError, TransportTimeoutError
from sim.registers import NO_SUCH_UNIT, RefusedError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from gonio.clock import Clock
    from sim.drive import Drive

REQUEST_S = 0.002
"""What a request and its reply take on the wire."""

_REPLY_TIMEOUT_S = 0.5


class TwinBus:
    """A `gonio.transports.RegisterBus` whose units are simulated.

    Parameters
    ----------
    drives
        By unit id.
    clock
        On which each request takes its time.
    advance
        Brings every drive up to the present: both axes of an arm shake its end.
    answers_for_unknown
        A gateway on TCP answers for units that are not there; on RTU nobody does.

    Attributes
    ----------
    powered
        Whether the drives have their supply; without it no unit is there.
    """

    def __init__(
        self,
        drives: Mapping[int, Drive],
        clock: Clock,
        advance: Callable[[float], None],
        *,
        answers_for_unknown: bool,
    ) -> None:
        self.powered = True
        self._drives = drives
        self._clock = clock
        self._advance = advance
        self._answers_for_unknown = answers_for_unknown

    def read(self, unit: int, address: int, count: int) -> list[int]:
        """Read registers (see `gonio.transports.RegisterBus`)."""
        drive = self._reach(unit, address)
        try:
            return drive.read(address, count, self._clock.now())
        except RefusedError as refused:
            raise RegisterError(unit, address, refused.code) from None

    def write(self, unit: int, address: int, values: Sequence[int]) -> None:
        """Write registers (see `gonio.transports.RegisterBus`)."""
        drive = self._reach(unit, address)
        try:
            drive.write(address, values, self._clock.now())
        except RefusedError as refused:
            raise RegisterError(unit, address, refused.code) from None

    def has(self, unit: int) -> bool:
        """Return whether a unit is there."""
        return self.powered and unit in self._drives

    def close(self) -> None:
        """Let go of the bus."""

    def _reach(self, unit: int, address: int) -> Drive:
        """Let a request travel to its unit."""
        self._clock.sleep(REQUEST_S)
        self._advance(self._clock.now())
        if self.has(unit):
            return self._drives[unit]
        if self._answers_for_unknown:
            raise RegisterError(unit, address, NO_SUCH_UNIT)
        self._clock.sleep(_REPLY_TIMEOUT_S)
        raise TransportTimeoutError(
            f"unit {unit}: no reply within {_REPLY_TIMEOUT_S:g} s; check the unit in the rig file"
        )
