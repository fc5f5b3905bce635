"""The making of a session: aside, then renamed, so that it is whole or not there."""

from __future__ import annotations

import errno
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from gonio.errors import BadInputError, StorageError
from gonio.files import sync_file, write_bytes
from gonio.planchain import FIRST_NAME
from gonio.reference import keep_reference
from gonio.session import Session

if TYPE_CHECKING:
    from collections.abc import Callable

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
    if root.exists() and (not root.is_dir() or any(root.iterdir())):
        raise _exists(root)
    try:
        root.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(
            dir=root.parent, prefix=f".{root.name}.", ignore_cleanup_errors=True
        ) as aside:
            session = Session(Path(aside) / "session")
            _fill(session, plan, rig_text, notes)
            if furnish is not None:
                furnish(session)
            _move(session.root, root)
    except OSError as error:
        raise StorageError.from_os(root, error) from error
    return Session(root)


def _fill(session: Session, plan: Plan, rig_text: str, notes: Notes) -> None:
    for folder in (session.plans, session.calibration, session.raw):
        folder.mkdir(parents=True)
    write_bytes(session.rig_path, rig_text.encode())
    keep_reference(session)
    notes.save(session.notes_path)
    plan.save(session.plans / FIRST_NAME)


def _move(aside: Path, root: Path) -> None:
    try:
        aside.rename(root)
    except OSError as error:
        if error.errno in (errno.ENOTEMPTY, errno.EEXIST):
            raise _exists(root) from None
        raise
    sync_file(root.parent)


def _exists(root: Path) -> BadInputError:
    return BadInputError(
        f"{root}: exists already and is never overwritten; name another folder with -o, or go on "
        f"with what was begun there: {Session(root).resume_command}"
    )
