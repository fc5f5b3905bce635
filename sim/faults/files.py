"""A camera whose files come late, broken or never: where it writes them, and not where they go."""

from __future__ import annotations

import errno
import os
from typing import TYPE_CHECKING

from gonio.errors import StorageError
from sim.faults.frames import broken
from sim.tether import write_frame

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.clock import VirtualClock
    from sim.faults.injector import Injector


class FaultyFiles:
    """Writes frames into a folder, as `sim.tether.Tether.write` is to.

    Parameters
    ----------
    clock
        On which late files take their time.
    injector
        Says what strikes.
    """

    def __init__(self, clock: VirtualClock, injector: Injector) -> None:
        self._clock, self._injector = clock, injector

    def write(self, folder: Path, frame: int, data: bytes) -> None:
        """Write a frame.

        Raises
        ------
        gonio.errors.StorageError
            When the disk is full, or said to be.
        """
        fault = self._injector.strike("folder", "frame")
        kind = fault.kind if fault else ""
        if kind == "disk full":
            raise StorageError.from_os(folder, OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))
        if fault is not None and kind == "frame late":
            late_s = self._clock.now() + fault.duration_s
            self._clock.call_at(late_s, lambda: write_frame(folder, frame, data))
        elif kind != "frame missing":
            write_frame(folder, frame, broken(data, kind, self._injector.random))
