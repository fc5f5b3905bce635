"""The folder that holds one measurement: its plans, rig, frames, samples, model and report."""

from __future__ import annotations

import contextlib
import fcntl
import os
import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from gonio.errors import BadFileError, BadInputError, ResumeRefusedError, StorageError
from gonio.files import write_json
from gonio.journal import Journal
from gonio.notes import Notes
from gonio.planchain import FIRST_NAME, load_chain
from gonio.rig import load_rig
from gonio.validation import parse_json, read_text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.plan import Plan
    from gonio.planchain import PlanChain
    from gonio.rig import Rig

DEFAULT_ROOT: Final = Path("session")
"""Where commands look for a session unless told otherwise."""

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
    def open(cls, root: Path) -> Session:
        """Open an existing session.

        Raises
        ------
        gonio.errors.BadFileError
            When the folder is no session.
        """
        session = cls(root)
        if not root.is_dir():
            raise BadFileError(root, "no such folder", _REMEDY)
        if not (session.plans / FIRST_NAME).is_file():
            raise BadFileError(root, "is not a session (it has no plans/000.json)", _REMEDY)
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
        simulated = ["--sim"] if self.sim.is_dir() else []
        elsewhere = [] if self.root == DEFAULT_ROOT else ["-o", str(self.root)]
        return shlex.join(["gonio", "capture", *simulated, "--resume", *elsewhere])

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
        """Open the journal to be read, or, held by `lock`, to be written.

        Raises
        ------
        gonio.errors.ResumeRefusedError
            When it would be made, but frames are there that only a lost journal can vouch for.
        """
        frames = (*self.calibration.glob("*.dng"), *self.raw.glob("*.dng"))
        if frames and writing and not self.journal_path.exists():
            raise ResumeRefusedError(
                f"{self.journal_path}: is gone, and the frames that it vouched for are there; "
                "put it back, or start a new session with -o"
            )
        return Journal(self.journal_path, writing=writing)

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
        with (self.root / ".lock").open("w") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise BadInputError(
                    f"{self.root}: another gonio works on this session; wait for it or stop it"
                ) from None
            yield

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
