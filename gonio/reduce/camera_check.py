"""Whether a session's frames are of the camera that its calibration was made with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.errors import BadFileError
from gonio.reduce.correction import correction_in
from gonio.reduce.raw import decode_raw, read_vouched

if TYPE_CHECKING:
    from gonio.journal import Journal
    from gonio.session import Session


def check_camera(session: Session, journal: Journal) -> None:
    """Look at a dark frame, so that no night is spent on frames that are of no use.

    Raises
    ------
    gonio.errors.BadInputError
        Naming what differs.
    """
    if not session.sensor_calibration.is_dir() or session.notes().rehearsal:
        return
    for record in journal.frames():
        if record.role != "dark":
            continue
        path = session.root / record.file
        try:
            raw = decode_raw(read_vouched(path, record.sha256, ""), path, "")
        except BadFileError:
            continue  # one that is lost or damaged is left to the reduction
        correction_in(session.sensor_calibration).check(raw.sensor)
        break
