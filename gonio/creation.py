"""The making of a session: aside, then renamed, so that it is whole or not there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.files import write_bytes
from gonio.newfolder import new_folder
from gonio.planchain import FIRST_NAME
from gonio.reference import keep_reference
from gonio.session import Session

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from gonio.notes import Notes
    from gonio.plan import Plan


def create_session(
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
    gonio.errors.BadInputError
        When `root` exists and is not an empty folder.
    gonio.errors.StorageError
        When the operating system refuses.
    """
    remedy = (
        "name another folder with -o, or go on with what was begun there: "
        f"{Session(root).resume_command}"
    )
    with new_folder(root, remedy) as aside:
        session = Session(aside)
        _fill(session, plan, rig_text, notes)
        if furnish is not None:
            furnish(session)
    return Session(root)


def _fill(session: Session, plan: Plan, rig_text: str, notes: Notes) -> None:
    for folder in (session.plans, session.calibration, session.raw):
        folder.mkdir(parents=True)
    write_bytes(session.rig_path, rig_text.encode())
    keep_reference(session)
    notes.save(session.notes_path)
    plan.save(session.plans / FIRST_NAME)
