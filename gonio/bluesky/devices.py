"""Arm, lamps, camera and holder as devices of Bluesky (`bluesky.protocols`)."""

from __future__ import annotations

import contextlib
import threading
from typing import TYPE_CHECKING, Any, Final

from gonio.capture.frames import FrameTaker
from gonio.capture.usage import Stopwatch
from gonio.errors import DeviceFaultError
from gonio.rig import AXES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from gonio.bluesky.record import Record
    from gonio.bluesky.status import Work, Worker
    from gonio.capture import Instrument, Operator
    from gonio.capture.instrument import Holder
    from gonio.capture.lighting import Lighting
    from gonio.capture.wanted import Missing, Wanted
    from gonio.intact import FrameKey
    from gonio.journal import FrameRecord, Journal
    from gonio.plan import LampSetting
    from gonio.rig import Rig
    from gonio.session import Session

    Readings = dict[str, dict[str, Any]]

LAMPS: Final = 11


class Device:
    """What all four share: a name, no parent, and the rig's thread."""

    parent = None

    def __init__(self, name: str, instrument: Instrument, worker: Worker) -> None:
        self.name = name
        self._instrument = instrument
        self._worker = worker

    def _readings(self, values: Mapping[str, object]) -> Readings:
        now = self._instrument.clock.utc().timestamp()
        return {f"{self.name}_{key}": {"value": v, "timestamp": now} for key, v in values.items()}

    def _keys(self, shapes: Mapping[str, tuple[str, list[int], str | None]]) -> Readings:
        return {
            f"{self.name}_{key}": {"source": f"gonio:{self.name}", "dtype": dtype, "shape": shape}
            | ({} if units is None else {"units": units})
            for key, (dtype, shape, units) in shapes.items()
        }


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


class LampsDevice(Device):
    """Lamps 1 to 11: set to the settings of a shot, all others dark.

    Movable, Readable, Stageable and Pausable; dark when paused or unstaged, warm before they are
    trusted again.
    """

    def __init__(self, lighting: Lighting, instrument: Instrument, worker: Worker) -> None:
        super().__init__("lamps", instrument, worker)
        self._lighting = lighting
        self._lit: dict[int, float] = {}

    def set(self, settings: Sequence[LampSetting]) -> Work:
        """Light some at their currents, read back, and wait until they are warm."""
        return self._worker.begin(self._apply, tuple(settings))

    def read(self) -> Readings:
        """Return the currents that were read back, in mA."""
        return self._readings({"mA": [self._lit.get(n, 0.0) for n in range(1, LAMPS + 1)]})

    def describe(self) -> Readings:
        """Return what `read` returns, in Bluesky's words."""
        return self._keys({"mA": ("array", [LAMPS], "mA")})

    def stage(self) -> Work:
        """Ask the head who it is."""
        return self._worker.begin(self._instrument.lamps.identify)

    def unstage(self) -> Work:
        """Switch all off."""
        return self._worker.begin(self._off)

    def pause(self) -> None:
        """Switch all off."""
        self._worker.do(self._off)

    def resume(self) -> None:
        """Do nothing: the plan goes back to where lamps are set."""

    def _apply(self, settings: Sequence[LampSetting]) -> None:
        if settings:
            self._lighting.apply(settings)
        else:
            self._lighting.off()
        self._lit = {setting.n: setting.mA for setting in settings}

    def _off(self) -> None:
        self._lit = {}
        self._lighting.off()


class CameraDevice(Device):
    """The camera: prepared with a frame of the session, triggered, read when its file is safe.

    Preparable, Triggerable, Readable and Stageable. Files are named, hashed and journaled as by
    `gonio capture`.
    """

    def __init__(
        self,
        session: Session,
        instrument: Instrument,
        journal: Journal,
        missing: Missing,
        worker: Worker,
    ) -> None:
        super().__init__("camera", instrument, worker)
        self._session, self._missing = session, missing
        stopwatch = Stopwatch(instrument.clock)
        self._taker = FrameTaker(session, instrument, journal, stopwatch, self._took)
        self._wanted: Wanted | None = None
        self._records: dict[FrameKey, FrameRecord] = {}

    def prepare(self, value: Wanted) -> Work:
        """Say which frame is next."""
        return self._worker.begin(self._choose, value)

    def trigger(self) -> Work:
        """Expose it, and fetch, verify and journal its file."""
        return self._worker.begin(self._take)

    def read(self) -> Readings:
        """Return the last frame: what it is, its file in the session, SHA-256, and the flux."""
        record = self._records.get(self._named().key)
        if record is None:
            raise DeviceFaultError("camera: nothing was exposed yet; trigger it before it is read")
        values = {name: getattr(record, name) for name in _FRAME if name != "flux"}
        return self._readings(values | {"flux": list(record.flux)})

    def describe(self) -> Readings:
        """Return what `read` returns, in Bluesky's words."""
        return self._keys(_FRAME)

    def stage(self) -> Work:
        """Greet the camera."""
        return self._worker.begin(self._instrument.camera.prepare)

    def unstage(self) -> Work:
        """Take in a file that is still on its way."""
        return self._worker.begin(self._taker.keep)

    def _choose(self, wanted: Wanted) -> None:
        self._wanted = wanted

    def _take(self) -> None:
        wanted = self._named()
        # whoever goes back to a checkpoint comes to frames that are safe
        if wanted.key not in self._records:
            folder = self._session.raw if wanted.role == "shot" else self._session.calibration
            self._taker.take([wanted], folder)
            self._taker.fetch()

    def _took(self, record: FrameRecord) -> None:
        self._missing.took(record)
        self._records[record.key] = record

    def _named(self) -> Wanted:
        if self._wanted is None:
            raise DeviceFaultError("camera: no frame was named; prepare it with one")
        return self._wanted


_FRAME: Final[dict[str, tuple[str, list[int], str | None]]] = {
    "role": ("string", [], None),
    "shot_index": ("integer", [], None),
    "repeat": ("integer", [], None),
    "exposure_s": ("number", [], "s"),
    "file": ("string", [], None),
    "sha256": ("string", [], None),
    "flux": ("array", [LAMPS], None),
}


class HolderDevice(Device):
    """What lies under the camera: set to "reference" or "sample", by the operator's hand."""

    def __init__(
        self, lighting: Lighting, instrument: Instrument, operator: Operator, worker: Worker
    ) -> None:
        super().__init__("holder", instrument, worker)
        self._lighting, self._operator = lighting, operator

    def set(self, what: Holder) -> Work:
        """Have it laid there; with hands in the rig lamps are off and drives let go."""
        return self._worker.begin(self._place, what)

    def _place(self, what: Holder) -> None:
        if self._operator.by_hand:
            self._lighting.off()  # so that they warm up again
        self._instrument.place(self._operator, what)
