"""A folder of frames that come late, broken or never."""

from __future__ import annotations

import errno
import os
from typing import TYPE_CHECKING

from gonio.errors import StorageError
from sim.faults.frames import broken

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.clock import Clock
    from gonio.transports import FrameFolder
    from sim.faults.document import Fault
    from sim.faults.injector import Injector


class FaultyFolder:
    """A `gonio.transports.FrameFolder` around another one.

    Parameters
    ----------
    folder
        The folder.
    clock
        On which late files take their time.
    injector
        Says what strikes.
    """

    def __init__(self, folder: FrameFolder, clock: Clock, injector: Injector) -> None:
        self._folder = folder
        self._clock = clock
        self._injector = injector
        self._known: dict[str, Fault | None] = {}
        self._shown_from_s: dict[str, float] = {}

    def names(self) -> set[str]:
        """Return the names of the whole frames that are there now."""
        return {name for name in self._folder.names() if self._is_there(name)}

    def take(self, name: str, target: Path) -> None:
        """Move a frame out to `target` (see `gonio.transports.FrameFolder`)."""
        fault = self._known.pop(name, None)
        self._shown_from_s.pop(name, None)
        if fault is not None and fault.kind == "disk full":
            raise StorageError.from_os(target, OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))
        self._folder.take(name, target)
        if fault is not None:
            target.write_bytes(broken(target.read_bytes(), fault.kind, self._injector.random))

    def set_aside(self) -> int:
        """Move away whatever lies there from an earlier run; return how many files."""
        self._known.clear()
        self._shown_from_s.clear()
        return self._folder.set_aside()

    def _is_there(self, name: str) -> bool:
        if name not in self._known:
            fault = self._known[name] = self._injector.strike("folder", "frame")
            if fault is not None and fault.kind == "frame late":
                self._shown_from_s[name] = self._clock.now() + fault.duration_s
        fault = self._known[name]
        if fault is not None and fault.kind == "frame missing":
            return False
        return self._clock.now() >= self._shown_from_s.get(name, 0.0)
