"""Whether a session's frames are of the camera that its calibration was made with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.reduce.correction import correction_in
from gonio.reduce.raw import decode_raw, read_vouched

if TYPE_CHECKING:
    from gonio.journal import Journal
    from gonio.session import Session


def check_camera(session: Session, journal: Journal) -> None:
    """Look at the first dark frame, so that no night is spent on frames that are of no use.

    Raises
    ------
    gonio.errors.BadInputError
        Naming what differs.
    gonio.errors.BadFileError
        When that frame cannot be read.
    """
    first = next((record for record in journal.frames() if record.role == "dark"), None)
    if first is None or not session.sensor_calibration.is_dir() or session.notes().rehearsal:
        return
    path = session.root / first.file
    raw = decode_raw(read_vouched(path, first.sha256, "look at the camera"), path, "")
    correction_in(session.sensor_calibration).check(raw.sensor)
