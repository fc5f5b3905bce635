"""A rehearsal: what it cannot be asked for, where its frames go, what it says."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.devices import LocalFolder
from gonio.errors import BadInputError, ResumeRefusedError, StorageError
from gonio.words import duration

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.session import Session


def check_shown_nothing(material: str | None, *, adaptive: bool) -> None:
    """Refuse options about what frames show.

    Raises
    ------
    gonio.errors.BadInputError
        Naming the first.
    """
    for option, is_given in (("--material", material is not None), ("--adaptive", adaptive)):
        if is_given:
            raise BadInputError(
                f"{option} does not go with --rehearse, whose frames show nothing; "
                "leave one of them out"
            )


def check_begun_so(session: Session) -> None:
    """Refuse to go on with a measurement as a rehearsal.

    Raises
    ------
    gonio.errors.ResumeRefusedError
        Saying so.
    """
    if not session.notes().rehearsal:
        raise ResumeRefusedError(
            f"{session.root}: was not begun as a rehearsal; resume without --rehearse, or rehearse "
            "into a new session with -o"
        )


def concluded(wall_s: float) -> str:
    """Return the last words of a rehearsal that took the computer `wall_s`."""
    return (
        f"rehearsed in {duration(wall_s)} of this computer; its frames show nothing, so there is "
        "nothing to reconstruct"
    )


class UnsyncedFolder(LocalFolder):
    """A folder of frames that nobody will miss after a power cut."""

    def take(self, name: str, target: Path) -> None:
        """Move a frame out to `target` (see `gonio.transports.FrameFolder`)."""
        try:
            (self._path / name).replace(target)
        except OSError as error:
            raise StorageError.from_os(target, error) from error
