"""The run of a capture: dark frames, white reference, then shot after shot, all journaled."""

from __future__ import annotations

import shlex
import shutil
from typing import TYPE_CHECKING

from gonio.capture.frames import FrameTaker
from gonio.capture.lighting import Lighting
from gonio.capture.reach import check_reach
from gonio.capture.wanted import Missing
from gonio.errors import DeviceFaultError, StorageError
from gonio.paths import free_way
from gonio.rig import AXES
from gonio.timemodel import WHITE_POSE_DEG, frame_bytes

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from gonio.capture.instrument import Instrument, Operator
    from gonio.capture.wanted import Wanted
    from gonio.journal import Journal
    from gonio.plan import LampSetting, Shot
    from gonio.protocols import Progress
    from gonio.rig import Rig
    from gonio.session import Session

_SPARE_BYTES = 50_000_000


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
    """

    def __init__(
        self, session: Session, instrument: Instrument, operator: Operator, journal: Journal
    ) -> None:
        self._session = session
        self._instrument = instrument
        self._operator = operator
        self._journal = journal
        self._chain = session.chain()
        self._rig = session.rig()
        self._lighting = Lighting(instrument.lamps, self._rig.lamps, instrument.clock)
        self._missing = Missing(session, self._chain, journal.frames(), journal.rejected())

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
            When a device fails; what was taken is kept, and a resume goes on from there.

        Whatever ends a capture that a resume can go on with carries the command as a note.
        """
        try:
            return self._run(progress)
        except (DeviceFaultError, StorageError, KeyboardInterrupt) as stop:
            stop.add_note(f"go on with: {self._session.resume_command}")
            raise

    def _run(self, progress: Progress | None) -> int:
        dark, white = self._missing.dark(), self._missing.white()
        shots = [(shot, self._missing.of_shot(shot)) for shot in self._chain.shots]
        todo = [(shot, frames) for shot, frames in shots if frames]
        total = len(dark) + len(white) + sum(len(frames) for _, frames in todo)
        check_reach([shot for shot, _ in todo], self._rig)
        check_space(self._session.root, total, self._rig, self._space_remedy())
        if not total:
            return 0
        counter = _Counter(total, progress)
        self._note("begun", plan=self._chain.last.sha256, rig=self._rig.sha256, frames=total)
        with self._instrument.ready():
            self._note("homed")
            self._calibrate(dark, white, counter)
            self._operator.place("sample")
            with self._taker(counter) as taker:
                for shot, frames in todo:
                    self._take_shot(shot, frames, taker)
        self._note("finished")
        return total

    def _space_remedy(self) -> str:
        root = self._session.root
        if self._journal.frames():
            return "free some space"
        return f"free some space, or remove the session with: {shlex.join(['rm', '-r', str(root)])}"

    def _calibrate(
        self, dark: Sequence[Wanted], white: Sequence[Wanted], counter: _Counter
    ) -> None:
        if not dark and not white:
            return
        self._operator.place("reference")
        self._go(WHITE_POSE_DEG)
        self._lighting.off()
        with self._taker(counter) as taker:
            taker.take(dark, self._session.calibration)
            self._lighting.apply(self._white_lamps())
            taker.take(white, self._session.calibration)

    def _white_lamps(self) -> tuple[LampSetting, ...]:
        # each lamp that a plan ever lights, at its first current: the flux monitor does the rest
        settings = {lamp.n: lamp for shot in reversed(self._chain.shots) for lamp in shot.lamps}
        return tuple(settings[n] for n in sorted(settings))

    def _take_shot(self, shot: Shot, frames: Sequence[Wanted], taker: FrameTaker) -> None:
        self._go({name: shot.axis_deg(name) for name in AXES})
        self._lighting.apply(shot.lamps)
        taker.take(frames, self._session.raw)

    def _taker(self, counter: _Counter) -> FrameTaker:
        return FrameTaker(self._session, self._instrument, self._journal, counter.advance)

    def _go(self, angles_deg: Mapping[str, float]) -> None:
        """Go from where the arms are by a way on which nothing comes too near."""
        arm = self._instrument.arm
        here = arm.angles_deg()
        start, goal = ([angles[name] for name in AXES] for angles in (here, angles_deg))
        way = free_way(start, goal, self._rig)
        *via, last = [dict(zip(AXES, pose, strict=True)) for pose in way.poses_deg.tolist()]
        arm.move(last, via)

    def _note(self, kind: str, **data: object) -> None:
        self._journal.append(self._instrument.clock, kind, **data)


class _Counter:
    """Counts frames for whoever watches."""

    def __init__(self, total: int, progress: Progress | None) -> None:
        self._done, self._total, self._progress = 0, total, progress
        self._show()

    def advance(self) -> None:
        self._done += 1
        self._show()

    def _show(self) -> None:
        if self._progress is not None:
            self._progress(self._done, self._total)


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
