"""The calibration that a capture is to use, if it is of this rig and camera, and fresh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.api.twin import TwinSettings
    from gonio.calibration import CalibrationDocument
    from gonio.rig import Rig
    from gonio.session import Session


@dataclass(frozen=True)
class Asked:
    """A calibration that is whole, and how old it may be."""

    folder: Path
    document: CalibrationDocument
    max_age_days: float

    def check(self, rig: Rig, twin: TwinSettings | None) -> None:
        """Refuse one that is not of this rig and camera, or stale, by the capture's clock."""
        from gonio.calibrationfolder import check_usable
        from gonio.clock import SystemClock, VirtualClock

        now = (VirtualClock() if twin else SystemClock()).utc()
        camera = twin.camera if twin else None
        check_usable(self.document, self.folder, rig.sha256, camera, now, self.max_age_days)

    def keep(self, session: Session) -> None:
        """Copy it into a new session."""
        from gonio.calibrationfolder import keep_calibration

        keep_calibration(session, self.folder, self.document)


def asked_for(folder: Path | None, max_age_days: float | None, *, resume: bool) -> Asked | None:
    """Return the calibration of a folder, once nothing in it is found changed; None for none.

    Raises
    ------
    gonio.errors.BadInputError
        When it is not whole, or the options do not go together.
    gonio.errors.ResumeRefusedError
        On a resume, which keeps what the session was begun with.
    """
    from gonio.calibrationfolder import DEFAULT_MAX_AGE_DAYS, load_calibration
    from gonio.errors import BadInputError, ResumeRefusedError

    if folder is None:
        if max_age_days is not None:
            raise BadInputError("--max-age goes with --calibration; add that, or leave it out")
        return None
    if resume:
        raise ResumeRefusedError(
            "--calibration: a session keeps the one that it was begun with; leave it out"
        )
    age = DEFAULT_MAX_AGE_DAYS if max_age_days is None else max_age_days
    return Asked(folder, load_calibration(folder), age)
