"""The folder that holds one measurement: its plans, rig, frames, samples, model and report."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

from pydantic import Field

from gonio.errors import BadFileError, BadInputError, ResumeRefusedError, StorageError
from gonio.files import sync_file, write_bytes, write_json
from gonio.journal import Journal
from gonio.plan import Plan
from gonio.rig import Rig, load_rig
from gonio.validation import Document, check, parse_json, read_text

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

SCHEMA: Final = "gonio.session/1"
_REMEDY = "give the folder of a session that gonio capture made"


class Notes(Document):
    """What a reader years later will ask about a sample."""

    schema_: Literal["gonio.session/1"] = Field(default=SCHEMA, alias="schema")
    sample: str
    orientation: str
    mounting: str
    operator: str
    temperature_c: float | None = Field(default=None, ge=-273.15)


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
    def create(
        cls,
        root: Path,
        plan: Plan,
        rig_text: str,
        notes: Notes,
        furnish: Callable[[Session], None] | None = None,
    ) -> Session:
        """Make a new session, whole or not at all; an existing one is never touched.

        Parameters
        ----------
        root
            The folder; its parents are made where they are missing.
        plan, rig_text, notes
            What it is made of.
        furnish
            Adds more to the session before anybody can see it.

        Raises
        ------
        BadInputError
            When `root` exists and is not an empty folder.
        StorageError
            When the operating system refuses.
        """
        if root.exists() and (not root.is_dir() or any(root.iterdir())):
            raise _exists(root)
        try:
            return cls._create(root, plan, rig_text, notes, furnish)
        except OSError as error:
            raise StorageError.from_os(root, error) from error

    @classmethod
    def _create(
        cls,
        root: Path,
        plan: Plan,
        rig_text: str,
        notes: Notes,
        furnish: Callable[[Session], None] | None,
    ) -> Session:
        root.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(
            dir=root.parent, prefix=f".{root.name}.", ignore_cleanup_errors=True
        ) as aside:
            session = cls(Path(aside) / "session")
            session._fill(plan, rig_text, notes)
            if furnish is not None:
                furnish(session)
            cls._move(session.root, root)
        return cls(root)

    def _fill(self, plan: Plan, rig_text: str, notes: Notes) -> None:
        for folder in (self.plans, self.calibration, self.raw):
            folder.mkdir(parents=True)
        write_bytes(self.rig_path, rig_text.encode())
        write_json(self.notes_path, notes.model_dump(mode="json", by_alias=True))
        plan.save(self.plans / "000.json")

    @staticmethod
    def _move(aside: Path, root: Path) -> None:
        try:
            aside.rename(root)
        except OSError as error:
            if error.errno in (errno.ENOTEMPTY, errno.EEXIST):
                raise _exists(root) from None
            raise
        sync_file(root.parent)

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
        if not (session.plans / "000.json").is_file():
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

    def rig(self) -> Rig:
        """Return the rig that the session was made with."""
        return load_rig(self.rig_path)

    def notes(self) -> Notes:
        """Return what is noted of the sample."""
        text = read_text(self.notes_path, _REMEDY)
        return check(Notes, parse_json(text, self.notes_path, _REMEDY), self.notes_path, _REMEDY)

    def plan(self) -> Plan:
        """Return the session's plan.

        Raises
        ------
        gonio.errors.BadInputError
            When there are several: frames do not yet say which of them they belong to.
        """
        first, *others = self.chain()
        if others:
            raise BadInputError(
                f"{self.plans}: holds {1 + len(others)} plans, and this version measures one; "
                "start a new session with the other"
            )
        return first

    def chain(self) -> list[Plan]:
        """Return the plans, oldest first.

        Raises
        ------
        gonio.errors.BadFileError
            When a plan is damaged or does not name the one before it.
        """
        plans: list[Plan] = []
        for path in sorted(self.plans.glob("[0-9][0-9][0-9].json")):
            plan = Plan.load(path)
            parent = plans[-1].sha256 if plans else None
            if plan.parent != parent:
                raise BadFileError(
                    path, f"parent is {plan.parent}, not the plan before it ({parent})", _REMEDY
                )
            plans.append(plan)
        return plans

    def check_same(self, plan: Plan | None, rig: Rig | None) -> None:
        """Refuse to go on with another plan or rig than the session was begun with.

        Raises
        ------
        gonio.errors.ResumeRefusedError
            Saying what differs.
        """
        last = self.chain()[-1]
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

    def journal(self, *, must_exist: bool = True) -> Journal:
        """Open the journal.

        Raises
        ------
        gonio.errors.ResumeRefusedError
            When it may be made, but frames are there that only a lost journal can vouch for.
        """
        frames = (*self.calibration.glob("*.dng"), *self.raw.glob("*.dng"))
        if frames and not must_exist and not self.journal_path.exists():
            raise ResumeRefusedError(
                f"{self.journal_path}: is gone, and the frames that it vouched for are there; "
                "put it back, or start a new session with -o"
            )
        return Journal(self.journal_path, must_exist=must_exist)

    @contextlib.contextmanager
    def lock(self) -> Iterator[None]:
        """Hold the session against other processes; the lock goes with the process.

        Raises
        ------
        gonio.errors.BadInputError
            When another process holds it.
        """
        with (self.root / ".lock").open("w") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise BadInputError(
                    f"{self.root}: another gonio works on this session; wait for it or stop it"
                ) from None
            yield

    def note_timing(self, stage: str, seconds: float) -> None:
        """Record how long a stage took."""
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


def _exists(root: Path) -> BadInputError:
    return BadInputError(
        f"{root}: exists already and is never overwritten; continue it with --resume, "
        "or name another folder with -o"
    )
