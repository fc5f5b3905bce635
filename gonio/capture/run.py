"""The run of a capture: dark frames, white reference, then shot after shot, all journaled."""

from __future__ import annotations

import contextlib
import shlex
import shutil
from functools import partial
from typing import TYPE_CHECKING

from gonio.capture.attention import Attention
from gonio.capture.frames import FrameTaker
from gonio.capture.lighting import Lighting
from gonio.capture.reach import check_reach
from gonio.capture.recovery import Recovery
from gonio.capture.usage import Stopwatch
from gonio.capture.wanted import Missing
from gonio.clock import SystemClock
from gonio.errors import BadInputError, DeviceFaultError, StorageError
from gonio.files import make_folder
from gonio.intact import new_inputs
from gonio.rig import AXES
from gonio.steps import Steps
from gonio.timemodel import WHITE_POSE_DEG, frame_bytes

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from gonio.capture.instrument import Holder, Instrument, Operator
    from gonio.journal import FrameRecord, Journal
    from gonio.plan import LampSetting, Shot
    from gonio.protocols import Progress
    from gonio.rig import Rig
    from gonio.session import Session

_SPARE_BYTES = 50_000_000
# what failed is taken once more after all else, and once more after that
_PASSES = 3


class Capture:
    """One run over a session's plans in order; what is already there is not taken again.

    Parameters
    ----------
    session
        The session, locked by the caller.
    instrument, operator
        What to drive, and who lays sample and reference under the camera.
    journal
        The session's journal.
    judge
        Called once dark and white frames are there; what it raises ends the run before any shot.
    """

    def __init__(
        self,
        session: Session,
        instrument: Instrument,
        operator: Operator,
        journal: Journal,
        judge: Callable[[], None] = lambda: None,
    ) -> None:
        self._session = session
        self._instrument = instrument
        self._operator = operator
        self._journal = journal
        self._judge = judge
        self._chain = session.chain()
        self._rig = session.rig()
        self._lighting = Lighting(instrument.lamps, self._rig.lamps, instrument.clock)
        self._recovery = Recovery(instrument, self._lighting, self._note_fault)
        self._attention = Attention(
            session.root, instrument, self._lighting, self._note, SystemClock()
        )
        self._stopwatch = Stopwatch(instrument.clock)
        self._missing = Missing(session, self._chain, journal.frames(), journal.rejected())
        instrument.troubles.listener = self._note_fault

    def run(self, progress: Progress | None = None) -> int:
        """Take every missing frame.

        Returns
        -------
        int
            How many frames were taken; 0 when the session was complete.

        Raises
        ------
        gonio.errors.BadInputError
            When the rig cannot take a shot or go from one to the next; nothing has moved then.
        gonio.errors.StorageError
            When the disk will not hold the frames.
        gonio.errors.DeviceFaultError
            When a device fails and going on does not help; what was taken is kept, and a resume
            goes on from there.

        Whatever ends a capture that a resume can go on with carries the command as a note.
        """
        try:
            return self._run(progress)
        except (DeviceFaultError, StorageError, KeyboardInterrupt) as stop:
            stop.add_note(f"go on with: {self._session.resume_command}")
            with contextlib.suppress(StorageError):  # a full disk is what stopped it
                self._note_end("stopped", reason=str(stop) or "interrupted")
            raise

    def _run(self, progress: Progress | None) -> int:
        todo, dark, white = self._todo(), self._missing.dark(), self._missing.white()
        total = self._missing.count(todo)
        check_reach(todo, self._rig)
        check_space(self._session.root, total, self._rig, self._space_remedy())
        if not total:
            return 0
        counter = Steps(total, progress)
        counter.show()
        for folder in (self._session.calibration, self._session.raw):
            make_folder(folder)  # it may have gone with all its frames
        inputs = new_inputs(self._session.root, self._journal)
        plan, rig = self._chain.last.sha256, self._rig.sha256
        self._note("begun", plan=plan, rig=rig, frames=total, inputs=inputs)
        with self._instrument.ready(self._recovery.begin), self._taker(counter) as taker:
            self._note("homed")
            if dark or white:
                self._place("reference")
                self._persist(taker, self._calibration_left, self._calibrations)
            try:
                self._judge()
            except BadInputError as error:
                self._note_end("stopped", reason=str(error))
                raise
            self._place("sample")
            self._persist(taker, self._shots_left, self._shots)
        self._note_end("finished")
        return total

    def _place(self, what: Holder) -> None:
        if self._operator.by_hand:
            self._lighting.off()  # so that they warm up again
        self._instrument.place(self._operator, what)

    def _todo(self) -> list[Shot]:
        return [shot for shot in self._chain.shots if self._missing.of_shot(shot)]

    def _persist(
        self,
        taker: FrameTaker,
        left: Callable[[], str],
        todo: Callable[[], Sequence[Callable[[FrameTaker], None]]],
    ) -> None:
        """Do all that is to do, and what of it failed again, until nothing is left."""
        for _ in range(_PASSES):
            for take in todo():
                self._heed(taker)
                self._recovery.attempt(partial(_keeping, taker, take))
            self._recovery.attempt(taker.fetch)
            if not left():
                return
        raise DeviceFaultError(
            f"{left()} could not be taken in {_PASSES} passes; the last fault: "
            f"{self._recovery.last}"
        )

    def _heed(self, taker: FrameTaker) -> None:
        """Pause or stop where that is wished, with all that was exposed taken in."""
        while self._attention.is_wanted:
            taker.keep()
            self._recovery.attempt(self._attention.heed)

    def _space_remedy(self) -> str:
        root = self._session.root
        if self._journal.frames():
            return "free some space"
        return f"free some space, or remove the session with: {shlex.join(['rm', '-r', str(root)])}"

    def _calibration_left(self) -> str:
        frames = len(self._missing.dark()) + len(self._missing.white())
        return f"{frames} calibration frames" if frames else ""

    def _shots_left(self) -> str:
        shots = [str(shot.index) for shot in self._todo()]
        return f"shot {', '.join(shots)}" if shots else ""

    def _calibrations(self) -> list[Callable[[FrameTaker], None]]:
        return [self._calibrate]

    def _shots(self) -> list[Callable[[FrameTaker], None]]:
        return [partial(self._take_shot, shot) for shot in self._todo()]

    def _calibrate(self, taker: FrameTaker) -> None:
        dark = self._missing.dark()
        self._go(WHITE_POSE_DEG)
        if dark:
            self._lighting.off()
            taker.take(dark, self._session.calibration)
        self._lighting.apply(self._white_lamps())
        taker.take(self._missing.white(), self._session.calibration)

    def _white_lamps(self) -> tuple[LampSetting, ...]:
        # each lamp that a plan ever lights, at its first current: the flux monitor does the rest
        settings = {lamp.n: lamp for shot in reversed(self._chain.shots) for lamp in shot.lamps}
        return tuple(settings[n] for n in sorted(settings))

    def _take_shot(self, shot: Shot, taker: FrameTaker) -> None:
        self._go({name: shot.axis_deg(name) for name in AXES})
        self._lighting.apply(shot.lamps)
        taker.take(self._missing.of_shot(shot), self._session.raw)

    def _taker(self, counter: Steps) -> FrameTaker:
        def taken(record: FrameRecord) -> None:
            self._missing.took(record)
            self._recovery.progressed()
            counter()

        return FrameTaker(self._session, self._instrument, self._journal, self._stopwatch, taken)

    def _go(self, angles_deg: Mapping[str, float]) -> None:
        with self._stopwatch.moving():
            self._instrument.move_clear(angles_deg, self._rig)

    def _note_fault(self, what: str, did: str) -> None:
        self._note("fault", what=what, did=did)

    def _note_end(self, kind: str, **data: object) -> None:
        self._note(kind, usage=self._stopwatch.usage().model_dump(), **data)

    def _note(self, kind: str, **data: object) -> None:
        self._journal.append(self._instrument.clock, kind, **data)


def _keeping(taker: FrameTaker, take: Callable[[FrameTaker], None]) -> None:
    """Take something; when that fails, what was exposed before is still taken in."""
    try:
        take(taker)
    except DeviceFaultError:
        taker.keep()
        raise


def check_space(folder: Path, frames: int, rig: Rig, remedy: str) -> None:
    """Refuse a capture that the disk of `folder`, which need not be there yet, will not hold.

    Raises
    ------
    gonio.errors.StorageError
        Saying how much is needed, how much there is, and `remedy`.
    """
    there = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    need, free = frames * frame_bytes(rig) + _SPARE_BYTES, shutil.disk_usage(there).free
    if frames and need > free:
        raise StorageError(
            f"{folder}: the capture needs {need / 1e9:.2f} GB and the disk has {free / 1e9:.2f} GB "
            f"free; {remedy}"
        )
