"""Lamps, camera and holder as devices of Bluesky (`bluesky.protocols`)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from gonio.bluesky.device import Device
from gonio.capture.frames import FrameTaker
from gonio.capture.usage import Stopwatch
from gonio.errors import DeviceFaultError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.bluesky.device import Readings
    from gonio.bluesky.status import Work, Worker
    from gonio.capture import Instrument, Operator
    from gonio.capture.instrument import Holder
    from gonio.capture.lighting import Lighting
    from gonio.capture.wanted import Missing, Wanted
    from gonio.intact import FrameKey
    from gonio.journal import FrameRecord, Journal
    from gonio.plan import LampSetting
    from gonio.session import Session

LAMPS: Final = 11


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
