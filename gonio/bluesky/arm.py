"""The arm as a device of Bluesky (`bluesky.protocols`)."""

from __future__ import annotations

import contextlib
import threading
from typing import TYPE_CHECKING

from gonio.bluesky.device import Device
from gonio.errors import DeviceFaultError
from gonio.rig import AXES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from gonio.bluesky.device import Readings
    from gonio.bluesky.record import Record
    from gonio.bluesky.status import Work, Worker
    from gonio.capture import Instrument
    from gonio.rig import Rig


class ArmDevice(Device):
    """Four axes: set to angles in degrees by name, read from the encoders.

    Movable, Readable, Stageable (enabled and homed; left disabled), Stoppable and Pausable.
    """

    def __init__(self, instrument: Instrument, rig: Rig, worker: Worker, record: Record) -> None:
        super().__init__("arm", instrument, worker)
        self._rig, self._record = rig, record
        self._moving, self._lock = False, threading.Lock()

    def set(self, angles_deg: Mapping[str, float]) -> Work:
        """Move by a way on which nothing comes too near, until all axes are in place and still."""
        return self._worker.begin(self._move, dict(angles_deg))

    def read(self) -> Readings:
        """Return the encoders' angles."""
        angles = self._worker.do(self._instrument.arm.angles_deg)
        return self._readings({f"{name}_deg": angles[name] for name in AXES})

    def describe(self) -> Readings:
        """Return what `read` returns, in Bluesky's words."""
        return self._keys({f"{name}_deg": ("number", [], "deg") for name in AXES})

    def stage(self) -> Work:
        """Enable and home all axes."""
        return self._worker.begin(self._begin)

    def unstage(self) -> Work:
        """Stop and disable all axes."""
        return self._worker.begin(self._end)

    def pause(self) -> None:
        """Disable the axes, so that nobody is surprised and no watchdog waits."""
        self._worker.do(self._pause)

    def resume(self) -> None:
        """Enable them."""
        self._worker.do(self._resume)

    def stop(self, success: bool = False) -> None:
        """End a move that is under way, if there is one; its status fails."""
        del success
        with self._lock:
            # a RunEngine stops all that it ever moved at each run's end, too
            if self._moving:
                self._instrument.meanwhile.errand = self._halt

    def _begin(self) -> None:
        with self._stoppable():
            self._instrument.arm.enable()
            self._instrument.arm.home()
        self._record.home()

    def _end(self) -> None:
        try:
            self._instrument.arm.stop()
        finally:
            self._record.end()

    def _pause(self) -> None:
        self._instrument.arm.release()
        self._record.pause()

    def _resume(self) -> None:
        self._instrument.arm.enable()
        self._record.resume()

    def _move(self, angles_deg: Mapping[str, float]) -> None:
        with self._stoppable():
            self._instrument.move_clear(angles_deg, self._rig)

    @contextlib.contextmanager
    def _stoppable(self) -> Iterator[None]:
        self._under_way(True)
        try:
            yield
        finally:
            self._under_way(False)

    def _under_way(self, moving: bool) -> None:
        with self._lock:
            self._moving, self._instrument.meanwhile.errand = moving, None

    def _halt(self) -> bool:
        self._instrument.meanwhile.errand = None  # to come to rest takes waiting
        raise DeviceFaultError("arm: the move was stopped by the RunEngine; run the plan again")
