"""The folder that holds one measurement: its plans, rig, frames, samples, model and report."""

from __future__ import annotations

import contextlib
import fcntl
import os
import shlex
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, Self

from gonio.errors import BadFileError, BadInputError, ResumeRefusedError, StorageError
from gonio.files import write_json
from gonio.intact import check_intact
from gonio.journal import Journal
from gonio.notes import Notes
from gonio.planchain import FIRST_NAME, load_chain
from gonio.rig import load_rig
from gonio.validation import parse_json, read_text

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import IO

    from gonio.plan import Plan
    from gonio.planchain import PlanChain
    from gonio.rig import Rig

DEFAULT_ROOT: Final = Path("session")
"""Where commands look for a session unless told otherwise."""

_TRIES_S: Final = (0.0, 0.01, 0.02, 0.04, 0.08)
_REMEDY = "give the folder of a session that gonio capture made"


@dataclass(frozen=True)
class Session:
    """Where everything of one measurement lies.

    Attributes
    ----------
    root
        The folder.
    """

    root: Path

    @classmethod
    def open(cls, root: Path | str = DEFAULT_ROOT, *, measuring: bool = False) -> Self:
        """Open an existing session, of which nothing has changed that its journal vouches for.

        Parameters
        ----------
        root
            The folder.
        measuring
            Whether more frames are to be taken.

        Raises
        ------
        gonio.errors.BadFileError
            When the folder is no session.
        gonio.errors.ResumeRefusedError
            When its journal, a plan, its rig or its white reference is not what it was.
        """
        root = Path(root)
        session = cls(root)
        if not root.is_dir():
            raise BadFileError(root, "no such folder", _REMEDY)
        if not ((session.plans / FIRST_NAME).is_file() or session.journal_path.exists()):
            raise BadFileError(root, "is not a session (it has no plans/000.json)", _REMEDY)
        check_intact(session, measuring=measuring)
        session.notes()  # a damaged folder is told now, not after a night
        return session

    @property
    def plans(self) -> Path:
        """Folder of the chain of plans."""
        return self.root / "plans"

    @property
    def rig_path(self) -> Path:
        """The rig file as it was."""
        return self.root / "rig.toml"

    @property
    def notes_path(self) -> Path:
        """Sample, orientation, mounting, operator and temperature."""
        return self.root / "session.json"

    @property
    def calibration(self) -> Path:
        """Folder of dark and white frames."""
        return self.root / "calibration"

    @property
    def reference_path(self) -> Path:
        """The table of the white reference, where the rig file names one."""
        return self.calibration / "reference.npz"

    @property
    def sensor_calibration(self) -> Path:
        """Folder of the copy of a camera's calibration, where there is one."""
        return self.calibration / "sensor"

    @property
    def geometry_path(self) -> Path:
        """Camera and view arm as measured, where the session was given them."""
        return self.calibration / "geometry.json"

    @property
    def color_path(self) -> Path:
        """The camera's matrices by a chart, where the session was given them."""
        return self.calibration / "color.json"

    @property
    def raw(self) -> Path:
        """Folder of the shots' frames."""
        return self.root / "raw"

    @property
    def journal_path(self) -> Path:
        """The journal."""
        return self.root / "journal.sqlite"

    @property
    def samples_path(self) -> Path:
        """BRDF samples."""
        return self.root / "samples.nc"

    @property
    def checks_path(self) -> Path:
        """What the reduction thought of the frames."""
        return self.root / "checks.json"

    @property
    def model(self) -> Path:
        """Folder of the reconstructed material."""
        return self.root / "model"

    @property
    def report_path(self) -> Path:
        """The report."""
        return self.root / "report.html"

    @property
    def sim(self) -> Path:
        """Folder of what only the twin knows."""
        return self.root / "sim"

    @property
    def truth_path(self) -> Path:
        """The twin's material on the 81 x 81 grid; only report and compare may read it."""
        return self.sim / "truth.npz"

    @property
    def timings_path(self) -> Path:
        """Seconds that each stage took; kept apart, so that results stay equal to the bit."""
        return self.root / "timings.json"

    @property
    def resume_command(self) -> str:
        """What to type to go on with the capture."""
        return self._capture_command("--resume")

    @property
    def reconstruct_command(self) -> str:
        """What to type to make a material of it."""
        return shlex.join(["gonio", "reconstruct", str(self.root)])

    @property
    def retake_command(self) -> str:
        """What to type to take the shots again that a check flagged."""
        return self._capture_command("--retake")

    def _capture_command(self, option: str) -> str:
        simulated = ["--sim"] if self.sim.is_dir() else []
        elsewhere = [] if self.root == DEFAULT_ROOT else ["-o", str(self.root)]
        return shlex.join(["gonio", "capture", *simulated, option, *elsewhere])

    def rig(self) -> Rig:
        """Return the rig that the session was made with."""
        return load_rig(self.rig_path)

    def notes(self) -> Notes:
        """Return what is noted of the sample."""
        return Notes.load(self.notes_path)

    def chain(self) -> PlanChain:
        """Return the plans, oldest first (errors as `gonio.planchain.load_chain`)."""
        return load_chain(self.plans, self.rig().sha256)

    def add_plan(self, plan: Plan, source: Path | None = None) -> Path:
        """Add a plan to the chain, whole or not at all; the session is locked by the caller.

        Parameters
        ----------
        plan
            It names the last one as its parent.
        source
            The file that it came from, where it did.

        Returns
        -------
        Path
            The new file.

        Raises
        ------
        gonio.errors.ResumeRefusedError
            When the plan does not go on from the last one, or is for another rig.
        gonio.errors.StorageError
            When it cannot be written; the chain is then as it was.
        """
        chain = self.chain()
        path = self.plans / chain.next_name
        chain.check_next(plan, source or path)
        plan.save(path)
        return path

    def check_same(self, plan: Plan | None, rig: Rig | None) -> None:
        """Refuse to go on with another plan or rig than the session was begun with.

        Raises
        ------
        gonio.errors.ResumeRefusedError
            Saying what differs.
        """
        last = self.chain().last
        if plan is not None and plan.sha256 != last.sha256:
            raise ResumeRefusedError(
                f"{self.root}: was begun with plan {last.sha256[:12]}, not {plan.sha256[:12]}; "
                "resume without --plan, or start a new session with -o"
            )
        if rig is not None and rig.sha256 != self.rig().sha256:
            raise ResumeRefusedError(
                f"{self.root}: was begun with rig {self.rig().sha256[:12]}, not "
                f"{rig.sha256[:12]}; resume without --rig, or start a new session with -o"
            )

    def journal(self, *, writing: bool = False) -> Journal:
        """Open the journal to be read, or, held by `lock`, to be written."""
        synced = not (writing and self.notes().rehearsal)
        return Journal(self.journal_path, writing=writing, synced=synced)

    def clock_s(self) -> float:
        """Return when the last event was, in seconds on the session's own clock."""
        if not self.journal_path.is_file():
            return 0.0
        with self.journal() as journal:
            return max((event.at_s for event in journal.events()), default=0.0)

    @property
    def is_writable(self) -> bool:
        """Whether files can be made in the folder."""
        return os.access(self.root, os.W_OK)

    def check_writable(self, remedy: str) -> None:
        """Refuse, before any work is done, to write where nothing can be written.

        Raises
        ------
        gonio.errors.StorageError
            Telling `remedy`.
        """
        if not self.is_writable:
            raise StorageError(f"{self.root}: can only be read; {remedy}")

    @contextlib.contextmanager
    def lock(self) -> Iterator[None]:
        """Hold the session against other processes; the lock goes with the process.

        Who can only read it is in nobody's way, and holds nothing.

        Raises
        ------
        gonio.errors.BadInputError
            When another process holds it.
        """
        if not self.is_writable:
            yield
            return
        with self._lock_path.open("w") as file:
            # whoever asks `is_locked` in this instant is gone in the next
            if not any(_try_lock(file, fcntl.LOCK_EX, wait_s) for wait_s in _TRIES_S):
                raise BadInputError(
                    f"{self.root}: another gonio works on this session; wait for it or stop it"
                )
            yield

    @property
    def is_locked(self) -> bool:
        """Whether a process works on it, told without holding it longer than asking takes."""
        try:
            with self._lock_path.open() as file:
                return not _try_lock(file, fcntl.LOCK_SH)
        except FileNotFoundError:
            return False

    @property
    def _lock_path(self) -> Path:
        return self.root / ".lock"

    def note_timing(self, stage: str, seconds: float) -> None:
        """Record how long a stage took; a session that can only be read keeps what it has."""
        if self.is_writable:
            write_json(self.timings_path, self.timings() | {stage: round(seconds, 3)})

    def timings(self) -> dict[str, float]:
        """Return the seconds of each stage so far."""
        if not self.timings_path.is_file():
            return {}
        data = parse_json(read_text(self.timings_path, _REMEDY), self.timings_path, _REMEDY)
        try:
            return {stage: float(seconds) for stage, seconds in data.items()}
        except (AttributeError, TypeError, ValueError):
            remedy = "delete it"
            raise BadFileError(self.timings_path, "is not a table of seconds", remedy) from None


def _try_lock(file: IO[str], how: int, wait_s: float = 0.0) -> bool:
    """Try to lock an open file, after a wait; return whether that succeeded."""
    time.sleep(wait_s)
    try:
        fcntl.flock(file, how | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
