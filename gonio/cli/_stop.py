"""Stopping a rig, whoever drives it."""

from __future__ import annotations

import contextlib
import os
import signal
from pathlib import Path
from typing import TYPE_CHECKING

from gonio.capture import Instrument
from gonio.clock import SystemClock
from gonio.devices import LocalFolder
from gonio.devices.waiting import wait_until
from gonio.errors import DeviceFaultError, GonioError
from gonio.wire import ModbusBus, PortLine
from gonio.wire.lock import holders

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.rig import Rig

_END_TIMEOUT_S, _POLL_S = 10.0, 0.05


def stop_rig(rig: Rig) -> Iterator[str]:
    """Stop axes and lamps, and end other processes that drive the rig; yields what was done.

    Raises
    ------
    gonio.errors.DeviceFaultError
        For whatever could not be stopped, after everything was tried.
    """
    bus, line, clock = ModbusBus(rig.arm), PortLine(rig.lamps.device), SystemClock()
    folder = LocalFolder(Path(rig.camera.folder))
    instrument = Instrument.of(bus, line, folder, rig, clock)
    instrument.troubles.leaving = True
    with contextlib.closing(bus), contextlib.closing(line):
        # at once, before anything is waited for
        with contextlib.suppress(GonioError):
            instrument.arm.try_to_stop()
        failed = []
        for process in holders(rig):
            if _ends(process, rig, clock):
                yield f"process {process}, which drove the rig, has ended"
            else:
                failed.append(
                    f"process {process} drives the rig and does not end; stop it, then run this "
                    "again"
                )
        for what, stop in (("axes", instrument.arm.stop), ("lamps", instrument.lamps.shut)):
            try:
                stop()
            except GonioError as error:
                failed.append(str(error))
            else:
                yield f"{what}: {'stopped and disabled' if what == 'axes' else 'off'}"
    if failed:
        raise DeviceFaultError("; ".join(failed))


def _ends(process: int, rig: Rig, clock: SystemClock) -> bool:
    """Have a process end in order, which stops the rig as well; return whether it did."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.kill(process, signal.SIGTERM)

    def has_ended() -> bool:
        return process not in holders(rig)

    return wait_until(clock, has_ended, _END_TIMEOUT_S, _POLL_S)
