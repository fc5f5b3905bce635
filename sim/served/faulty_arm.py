"""The arm's wire with faults on it: frames that come spoiled, late, under a wrong name or never."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

from sim.faults.frames import doubled, dropped, flipped, sealed

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np

    from sim.faults.document import Fault
    from sim.faults.injector import Injector

    Spoil = Callable[[bytes, np.random.Generator], bytes]

_BUSY = 6
_REPLY_ONLY = ("bus bytes delayed", "bus wrong transaction")


def _another_transaction(frame: bytes, random: np.random.Generator) -> bytes:
    return bytes([frame[0] ^ 0x80]) + frame[1:]


def _another_unit(frame: bytes, random: np.random.Generator) -> bytes:
    return sealed(bytes([frame[0] + 1]) + frame[1:-2])


RTU: Final[Mapping[str, Spoil]] = {
    "bus CRC error": flipped,
    "bus bytes dropped": dropped,
    "bus bytes doubled": doubled,
    "bus wrong transaction": _another_unit,
}
"""What becomes of a reply on RTU; what is not named here is not sent."""

TCP: Final[Mapping[str, Spoil]] = {"bus wrong transaction": _another_transaction}
"""On TCP: nothing is spoiled there, but a gateway keeps what it finds spoiled behind it."""


class FaultyArm:
    """Stands between the drives and a port.

    Parameters
    ----------
    answer
        Returns the drives' reply to (unit, request), from the function code on; None for silence.
    axes
        Name of the axis of each unit.
    injector
        Says what strikes.
    spoil
        What becomes of replies, `RTU` or `TCP`.
    """

    def __init__(
        self,
        answer: Callable[[int, bytes], bytes | None],
        axes: Mapping[int, str],
        injector: Injector,
        spoil: Mapping[str, Spoil],
    ) -> None:
        self._answer, self._axes = answer, axes
        self._injector, self._spoil = injector, spoil
        self._on_reply: Fault | None = None
        self._quiet_until_s = 0.0

    def answer(self, unit: int, request: bytes) -> bytes | None:
        """Let a request travel there; return the reply, or None for silence."""
        if self._is_taken():
            return None
        fault = self._injector.strike("bus", "request", self._axes.get(unit))
        if fault is not None and fault.kind == "bus exception reply":
            return bytes([request[0] | 0x80, _BUSY])
        may_be_lost = fault is not None and fault.kind not in _REPLY_ONLY
        if may_be_lost and self._injector.random.random() < 0.5:
            return None
        self._on_reply = fault
        return self._answer(unit, request)

    def send(self, write: Callable[[bytes], None], frame: bytes) -> None:
        """Let the frame of a reply travel back by `write`."""
        fault, self._on_reply = self._on_reply, None
        if fault is None:
            write(frame)
        elif fault.kind in self._spoil:
            write(self._spoil[fault.kind](frame, self._injector.random))
        elif fault.kind == "bus bytes delayed":
            loop = asyncio.get_running_loop()
            self._quiet_until_s = loop.time() + fault.duration_s
            loop.call_later(fault.duration_s, write, frame)

    def _is_taken(self) -> bool:
        """Return whether a late reply holds the wire: RTU has one for all units, both ways."""
        return self._spoil is RTU and asyncio.get_running_loop().time() < self._quiet_until_s
