"""Whether a session is still what its journal says, before anything is built on it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from gonio.errors import BadFileError, ResumeRefusedError
from gonio.files import sha256_file
from gonio.reference import rig_with_reference

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence
    from pathlib import Path

    from gonio.journal import Event, FrameRecord, Journal
    from gonio.session import Session

_TWIN: Final = "sim/twin.json"
_PATTERNS = (
    "plans/[0-9][0-9][0-9].json", "rig.toml", "calibration/reference.*", "calibration/sensor/*",
    _TWIN,
)  # fmt: skip
_REMEDY = "put back what was there, or start a new session with -o"

FrameKey = tuple[str, int, int, float]
"""Role, shot, repeat and exposure: what makes a frame the one that was wanted."""


def new_inputs(root: Path, journal: Journal) -> dict[str, str]:
    """Return path and SHA-256 of what a session is measured with and no run has vouched for yet.

    That is the plans, the rig file, the table of the white reference, the camera's calibration, and
    the twin's settings.
    """
    known = _inputs(journal.events("begun"))
    files = {str(path.relative_to(root)): path for each in _PATTERNS for path in root.glob(each)}
    return {name: sha256_file(files[name]) for name in sorted(files.keys() - known.keys())}


def check_intact(session: Session, *, measuring: bool) -> None:
    """Refuse a session of which the journal, or what it is measured with, is not as it was.

    Parameters
    ----------
    session
        It need not be locked.
    measuring
        Whether frames are to be taken; only then the twin's settings and calibration frames matter.

    Raises
    ------
    gonio.errors.ResumeRefusedError
        Naming the first record or file that differs.
    """
    runs = _runs(session)
    if not runs and _has_frames(session):
        raise ResumeRefusedError(
            f"{session.journal_path}: is gone or empty, and the frames that it vouched for are "
            f"there; {_REMEDY}"
        )
    if not runs and measuring:
        _check_unbegun(session)
    _check_inputs(session.root, _inputs(runs), measuring=measuring)
    if runs and measuring:
        _check_calibration(session)


def _has_frames(session: Session) -> bool:
    return any(path for each in (session.calibration, session.raw) for path in each.glob("*.dng"))


def _check_unbegun(session: Session) -> None:
    """Check plan, rig and reference by each other, where no run has vouched for them yet."""
    try:
        meant, there = session.chain().plans[0].rig_sha256, session.rig().sha256
        rig_with_reference(session)
    except BadFileError as error:
        raise ResumeRefusedError(str(error)) from None
    if there != meant:
        raise ResumeRefusedError(
            f"{session.rig_path}: is not the rig that the plan was made for ({there[:12]}, not "
            f"{meant[:12]}); {_REMEDY}"
        )


def _runs(session: Session) -> list[Event]:
    """Return what each run began with, by a journal that is whole."""
    if not session.journal_path.exists():
        return []
    try:
        with session.journal() as journal:
            journal.check_chain()
            return list(journal.events("begun"))
    except BadFileError as error:
        raise ResumeRefusedError(str(error)) from None


def _inputs(runs: Iterable[Event]) -> dict[str, str]:
    # runs of before inputs were noted have none
    return {name: sha256 for run in runs for name, sha256 in run.data.get("inputs", {}).items()}


def _check_inputs(root: Path, inputs: Mapping[str, str], *, measuring: bool) -> None:
    for name, sha256 in inputs.items():
        path = root / name
        if name == _TWIN and not measuring:
            continue  # no later stage may know what the twin carries
        if not path.is_file():
            problem = "is no file" if path.exists() else "is missing"
        elif sha256_file(path) != sha256:
            problem = f"has changed since the capture began (its SHA-256 was {sha256[:12]})"
        else:
            continue
        raise ResumeRefusedError(f"{path}: {problem}; {_REMEDY}")


def _check_calibration(session: Session) -> None:
    """Refuse dark and white frames that changed: the samples of all shots hang on them."""
    with session.journal() as journal:
        records = [record for record in journal.frames() if record.role != "shot"]
        rejected = journal.rejected()
    have = verified_frames(session, records, rejected)
    for record in records:
        path = session.root / record.file
        if record.key not in have and record.file not in rejected and path.exists():
            raise ResumeRefusedError(
                f"{path}: has changed since the journal vouched for it; put back what was there, "
                "or remove it, and a resume takes it again"
            )


def verified_frames(
    session: Session, records: Sequence[FrameRecord], rejected: Collection[str] = ()
) -> dict[FrameKey, FrameRecord]:
    """Return the newest record of each frame whose file is there with the content it had.

    Files that the reduction has rejected do not count.
    """
    return {
        record.key: record
        for record in records
        if record.file not in rejected and _is_intact(session, record)
    }


def _is_intact(session: Session, record: FrameRecord) -> bool:
    path = session.root / record.file
    return path.is_file() and sha256_file(path) == record.sha256
