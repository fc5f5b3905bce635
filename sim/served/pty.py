"""A pseudo-terminal: the twin holds one end, a driver opens the other like a serial port."""

from __future__ import annotations

import asyncio
import os
import tty
from contextlib import suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

_CHUNK = 4096


class PseudoTerminal:
    """A serial port without a wire, under a name that stays when its number changes.

    Parameters
    ----------
    link
        Becomes a symbolic link to the device; one left behind is replaced.

    Attributes
    ----------
    device
        The device itself, such as `/dev/pts/3`.
    """

    def __init__(self, link: Path) -> None:
        self._link = link
        self._receive: Callable[[bytes], None] | None = None
        self._back: asyncio.TimerHandle | None = None
        self._plug_in()

    def listen(self, receive: Callable[[bytes], None]) -> None:
        """Have `receive` called with what a driver writes, on the running loop."""
        self._receive = receive
        asyncio.get_running_loop().add_reader(self._ours, self._ready)

    def send(self, data: bytes) -> None:
        """Send to the driver; where nobody reads, it is lost, as on a wire."""
        if self._back is None:
            with suppress(BlockingIOError):
                os.write(self._ours, data)

    def unplug(self, seconds: float) -> None:
        """Take the port away, and bring it back after so many seconds, under another number."""
        if self._back is None:
            self._pull_out()
            self._back = asyncio.get_running_loop().call_later(seconds, self._plug_in)

    def close(self) -> None:
        """Take the port away."""
        if self._back is None:
            self._pull_out()
        else:
            self._back.cancel()

    def _plug_in(self) -> None:
        # its own hold on the driver's end keeps the port alive while no driver has it open
        self._ours, self._theirs = os.openpty()
        tty.setraw(self._theirs)
        os.set_blocking(self._ours, False)
        self.device = os.ttyname(self._theirs)
        self._link.unlink(missing_ok=True)
        self._link.symlink_to(self.device)
        self._back = None
        if self._receive is not None:
            self.listen(self._receive)

    def _pull_out(self) -> None:
        asyncio.get_running_loop().remove_reader(self._ours)
        self._link.unlink(missing_ok=True)
        os.close(self._theirs)
        os.close(self._ours)

    def _ready(self) -> None:
        if self._receive is not None:
            with suppress(BlockingIOError):
                self._receive(os.read(self._ours, _CHUNK))
