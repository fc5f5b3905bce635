"""A session's white reference: of a table that the rig file names, a copy with its SHA-256."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from gonio.directions import from_degrees
from gonio.errors import BadFileError, ResumeRefusedError
from gonio.files import sha256_bytes, sha256_file, write_bytes, write_json
from gonio.materials import MeasuredTable
from gonio.timemodel import WHITE_POSE_DEG
from gonio.validation import Document, check, parse_json, read_text

if TYPE_CHECKING:
    from gonio.rig import Rig
    from gonio.session import Session

_REMEDY = "put back what the session was made with"


class KeptReference(Document):
    """Where a session's copy came from, and what it holds."""

    named: str
    sha256: str


def keep_reference(session: Session) -> None:
    """Copy the table that a new session's rig file names, if it names one, into the session.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing or no table, or black at the pose of the white frames.
    """
    named = session.rig().holder.reference
    if isinstance(named, str):
        _check_white(MeasuredTable.load(named), named)
        content = Path(named).read_bytes()
        write_bytes(session.reference_path, content)
        kept = KeptReference(named=named, sha256=sha256_bytes(content))
        write_json(_note(session), kept.model_dump())


def _check_white(table: MeasuredTable, named: str) -> None:
    """Refuse what sends no light to where the white frames are taken from."""
    light, view = (
        from_degrees(WHITE_POSE_DEG[f"{side}_theta"], WHITE_POSE_DEG[f"{side}_phi"])
        for side in ("light", "view")
    )
    if not table.evaluate(light, view).min() > 0:
        raise BadFileError(
            named,
            "is black where the white frames are taken from",
            "name the table of a white reference in [holder] reference",
        )


def kept_reference(session: Session) -> KeptReference | None:
    """Return what is noted of a session's table; None where the rig file states a factor.

    Raises
    ------
    gonio.errors.BadFileError
        When the note is missing or damaged.
    """
    if not isinstance(session.rig().holder.reference, str):
        return None
    path = _note(session)
    return check(KeptReference, parse_json(read_text(path, _REMEDY), path, _REMEDY), path, _REMEDY)


def rig_with_reference(session: Session) -> Rig:
    """Return a session's rig, naming the session's own copy where it names a table.

    Raises
    ------
    gonio.errors.BadFileError
        When the note of it is missing or damaged.
    gonio.errors.ResumeRefusedError
        When the copy is missing, or is not what the session was begun with.
    """
    rig, kept, copy = session.rig(), kept_reference(session), session.reference_path
    if kept is None:
        return rig
    if not copy.is_file() or sha256_file(copy) != kept.sha256:
        raise ResumeRefusedError(
            f"{copy}: is not the white reference that the session was begun with; put back "
            f"{kept.named} of SHA-256 {kept.sha256[:12]}"
        )
    holder = rig.holder.model_copy(update={"reference": str(copy)})
    return rig.model_copy(update={"holder": holder})


def _note(session: Session) -> Path:
    return session.reference_path.with_suffix(".json")
