"""Taking frames one after the other; the file of the last may come while the arms move on."""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.errors import FrameLostError, GonioError
from gonio.files import sha256_file
from gonio.journal import FrameRecord

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping
    from pathlib import Path
    from types import TracebackType

    from gonio.capture.instrument import Instrument
    from gonio.capture.usage import Stopwatch
    from gonio.capture.wanted import Wanted
    from gonio.devices import LatentFrame
    from gonio.journal import Journal
    from gonio.session import Session

# no finer than the wait for a file looks
_AT_ONCE_S = 0.02


@dataclass(frozen=True)
class _Exposed:
    """A frame whose shutter has closed and whose file is still on its way."""

    wanted: Wanted
    target: Path
    latent: LatentFrame
    angles_deg: Mapping[str, float]
    closed_s: float


class FrameTaker:
    """Exposes frames and takes their files in.

    The camera writes a file while the next thing happens: it is taken in while the arms move, as
    soon as it is there, and waited for before the next exposure and no sooner. A frame counts when
    its row is in the journal, which is written after its file is verified and synced, so whatever
    ends the capture before that loses this frame alone. The last one is fetched by whoever is done
    with taking.

    Parameters
    ----------
    session, instrument, journal
        Where frames go, what takes them, and what vouches for them.
    stopwatch
        Told what time goes into exposures and files.
    taken
        Called with the record of each frame that is safe.
    """

    def __init__(
        self,
        session: Session,
        instrument: Instrument,
        journal: Journal,
        stopwatch: Stopwatch,
        taken: Callable[[FrameRecord], None],
    ) -> None:
        self._session = session
        self._instrument = instrument
        self._journal = journal
        self._stopwatch = stopwatch
        self._taken = taken
        self._exposed: _Exposed | None = None
        self._watched = False
        self._failed: GonioError | None = None

    def __enter__(self) -> FrameTaker:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if isinstance(error, GonioError):
            self.keep()

    def keep(self) -> None:
        """Take in the file that is on its way, if it comes, whatever fault ended the rest."""
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
            with _naming(frame):
                latent = self._instrument.camera.expose(frame.exposure_s)
            self._stopwatch.exposed(frame.exposure_s)
            self._exposed = _Exposed(frame, folder / frame.name, latent, angles_deg, self._now())
            self._watched = False
            self._instrument.meanwhile.errand = self._look_meanwhile

    def fetch(self) -> None:
        """Wait for the file that is on its way, if any, and vouch for it (errors as `take`)."""
        began_s = self._now()
        if not self._look(began_s):
            self._take_in(began_s)
        failed, self._failed = self._failed, None
        if failed is not None:
            raise failed

    def _look_meanwhile(self) -> bool:
        return self._look(math.inf)

    def _look(self, waiting_since_s: float) -> bool:
        """Take in the file that is on its way if it is there; return whether none is any more."""
        exposed = self._exposed
        if exposed is None:
            return True
        there = self._instrument.camera.has(exposed.latent)
        self._watched |= not there or self._now() - exposed.closed_s <= _AT_ONCE_S
        if there:
            self._take_in(waiting_since_s)
        return there

    def _take_in(self, waiting_since_s: float) -> None:
        """Fetch and vouch for the file that is on its way; a failure is kept for `fetch`."""
        exposed, self._exposed = self._exposed, None
        if exposed is None:
            return
        try:
            with _naming(exposed.wanted):
                self._vouch(exposed)
        except GonioError as error:
            self._failed = error
        now_s = self._now()
        waited_s = max(now_s - waiting_since_s, 0.0)
        sent_s = exposed.closed_s if self._instrument.camera.sends else waiting_since_s
        self._stopwatch.fetched(now_s - sent_s, waited_s, watched=self._watched)

    def _vouch(self, exposed: _Exposed) -> None:
        # the camera syncs file and folder before the row that vouches for them
        self._instrument.camera.fetch(exposed.latent, exposed.target)
        record = self._record(exposed)
        self._journal.append_frame(self._instrument.clock, record)
        self._taken(record)

    def _now(self) -> float:
        return self._instrument.clock.now()

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
            flux=exposed.latent.flux,
            **{f"{name}_deg": angle for name, angle in exposed.angles_deg.items()},
        )


@contextlib.contextmanager
def _naming(wanted: Wanted) -> Iterator[None]:
    """Have a lost frame say which one it is."""
    try:
        yield
    except FrameLostError as error:
        error.add_note(f"it is {wanted.role} {wanted.shot_index}, {wanted.exposure_s:g} s")
        raise
