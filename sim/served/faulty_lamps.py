"""The lamps' wire with faults on it: lines that come spoiled, late, twice or never."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from gonio.errors import TransportTimeoutError
from sim.faults.line import EITHER_WAY, SPOIL

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.transports import SerialLine
    from sim.faults.document import Fault
    from sim.faults.injector import Injector


class FaultyLamps:
    """A `gonio.transports.SerialLine` to the lamp head, and the way back from it.

    Parameters
    ----------
    line
        The line.
    injector
        Says what strikes.
    write
        Sends bytes to the driver.
    unplug
        Takes the port away for so many seconds.
    """

    def __init__(
        self,
        line: SerialLine,
        injector: Injector,
        write: Callable[[bytes], None],
        unplug: Callable[[float], None],
    ) -> None:
        self._line, self._injector = line, injector
        self._write, self._unplug = write, unplug
        self._on_answer: Fault | None = None
        self._is_lost = False

    def send(self, line: bytes) -> None:
        """Let a request travel there (see `gonio.transports.SerialLine`)."""
        fault = self._injector.strike("line", "request")
        kind = fault.kind if fault else ""
        out = kind in EITHER_WAY and bool(self._injector.random.random() < 0.5)
        self._on_answer = None if out else fault
        self._is_lost = kind == "serial port unplugged" or (out and kind not in SPOIL)
        if fault is not None and kind == "serial port unplugged":
            self._unplug(fault.duration_s)
        if not self._is_lost:
            spoil = SPOIL.get(kind) if out else None
            self._line.send(spoil(line, self._injector.random) if spoil else line)

    def receive(self, timeout_s: float) -> bytes:
        """Return the next answer (see `gonio.transports.SerialLine`)."""
        if self._is_lost:
            raise TransportTimeoutError("lamps: the request is lost; ask again")
        return self._line.receive(timeout_s)

    def answer(self, data: bytes) -> None:
        """Let an answer travel back, line ending and all."""
        fault, self._on_answer = self._on_answer, None
        if fault is None:
            self._write(data)
        elif fault.kind in SPOIL:
            self._write(SPOIL[fault.kind](data, self._injector.random))
        elif fault.kind == "line answer doubled":
            self._write(data + data)
        elif fault.kind == "line bytes delayed":
            asyncio.get_running_loop().call_later(fault.duration_s, self._write, data)

    def close(self) -> None:
        """Let go of the line."""
        self._line.close()
