"""Taking frames one after the other; the file of the last may come while the arms move on."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.errors import GonioError
from gonio.files import sha256_file
from gonio.journal import FrameRecord

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from pathlib import Path
    from types import TracebackType

    from gonio.capture.instrument import Instrument
    from gonio.capture.wanted import Wanted
    from gonio.devices import Exposure
    from gonio.journal import Journal
    from gonio.session import Session


@dataclass(frozen=True)
class _Exposed:
    """A frame whose shutter has closed and whose file is still on its way."""

    wanted: Wanted
    target: Path
    exposure: Exposure
    before: set[str]
    angles_deg: Mapping[str, float]


class FrameTaker:
    """Exposes frames and takes their files in; at its end none is on its way.

    The camera writes a file while the next thing happens: it is fetched before the next exposure
    and no sooner. A frame counts when its row is in the journal, which is written after its file is
    verified and synced, so whatever ends the capture before that loses this frame alone.

    Parameters
    ----------
    session, instrument, journal
        Where frames go, what takes them, and what vouches for them.
    taken
        Called after each frame that is safe.
    """

    def __init__(
        self,
        session: Session,
        instrument: Instrument,
        journal: Journal,
        taken: Callable[[], None],
    ) -> None:
        self._session = session
        self._instrument = instrument
        self._journal = journal
        self._taken = taken
        self._exposed: _Exposed | None = None

    def __enter__(self) -> FrameTaker:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is None:
            self.fetch()
        elif isinstance(error, GonioError):
            # what a later fault ends was exposed well; that fault is the one to report
            with contextlib.suppress(GonioError):
                self.fetch()

    def take(self, frames: Iterable[Wanted], folder: Path) -> None:
        """Expose frames into `folder`; all but the last are safe when it returns.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When a frame is not exposed, or the file of the one before it does not come.
        gonio.errors.StorageError
            When a file or its row cannot be written.
        """
        for frame in frames:
            self.fetch()
            angles_deg = self._instrument.arm.angles_deg()
            before = self._instrument.camera.names()
            exposure = self._instrument.lamps.expose(frame.exposure_s)
            self._exposed = _Exposed(frame, folder / frame.name, exposure, before, angles_deg)

    def fetch(self) -> None:
        """Wait for the file that is on its way, if any, and vouch for it (errors as `take`)."""
        exposed, self._exposed = self._exposed, None
        if exposed is None:
            return
        try:
            # the camera syncs file and folder before the row that vouches for them
            self._instrument.camera.fetch(exposed.exposure.frame, exposed.before, exposed.target)
        except GonioError as error:
            wanted = exposed.wanted
            error.add_note(f"it is {wanted.role} {wanted.shot_index}, {wanted.exposure_s:g} s")
            raise
        self._journal.append_frame(self._instrument.clock, self._record(exposed))
        self._taken()

    def _record(self, exposed: _Exposed) -> FrameRecord:
        frame, target = exposed.wanted, exposed.target
        return FrameRecord(
            role=frame.role,
            shot_index=frame.shot_index,
            attempt=frame.attempt,
            repeat=frame.repeat,
            exposure_s=frame.exposure_s,
            file=str(target.relative_to(self._session.root)),
            sha256=sha256_file(target),
            flux=exposed.exposure.flux,
            **{f"{name}_deg": angle for name, angle in exposed.angles_deg.items()},
        )
