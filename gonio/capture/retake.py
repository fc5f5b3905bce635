"""Shots that the checks flagged, given up so that a capture takes them anew."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.checks import Checks
from gonio.errors import BadFileError, BadInputError
from gonio.samples import Samples

if TYPE_CHECKING:
    from gonio.journal import Journal
    from gonio.session import Session


def flagged(session: Session) -> Checks:
    """Return the checks of a session's samples.

    Raises
    ------
    gonio.errors.BadInputError
        When there are none, or the samples were made anew since.
    """
    remedy = f"run: gonio reduce {session.root}"
    if not session.checks_path.is_file():
        raise BadInputError(
            f"{session.root}: has no checks yet, which say what to take again; {remedy}"
        )
    checks = Checks.load(session.checks_path)
    if Samples.load(session.samples_path).provenance.get("frames") != checks.frames:
        raise BadFileError(session.checks_path, "is not of the samples that are there", remedy)
    return checks


def give_up(checks: Checks, journal: Journal) -> int:
    """Reject the frames of all suspects, and return how many shots that are.

    Nothing is deleted: a frame that is rejected counts no more, and the next try at it has a higher
    `attempt`. What was taken again since the checks were made is left alone.
    """
    known, given_up = journal.rejected(), 0
    for suspect in checks.suspects:
        files = [file for file in suspect.files if file not in known]
        for file in files:
            journal.reject(file, f"taken again because of: {suspect.problem}")
        given_up += bool(files)
    return given_up
