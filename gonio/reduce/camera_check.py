"""Whether a session's frames are of the camera that its calibration was made with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.calibrationfolder import kept_calibration
from gonio.errors import BadFileError, BadInputError
from gonio.reduce.correction import difference
from gonio.reduce.raw import decode_raw, read_vouched

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.calibration import CameraIdentity
    from gonio.journal import FrameRecord, Journal
    from gonio.session import Session


def check_camera(session: Session, journal: Journal) -> None:
    """Look at a dark frame, so that no night is spent on frames that are of no use.

    Where it is of another setting, the journal rejects all dark and white frames that are, so that
    a resume takes them anew.

    Raises
    ------
    gonio.errors.BadInputError
        Naming what differs.
    """
    calibration = kept_calibration(session)
    if calibration is None or session.notes().rehearsal:
        return
    rejected = journal.rejected()
    records = [r for r in journal.frames() if r.role != "shot" and r.file not in rejected]
    darks = [record for record in records if record.role == "dark"]
    first = next(_identities(session, darks), None)
    if first is None or not (differs := difference(calibration.camera, first[1])):
        return
    for record, identity in _identities(session, records):
        if problem := difference(calibration.camera, identity):
            journal.reject(record.file, f"is not of the calibration's camera: {problem}")
    raise BadInputError(
        f"{session.sensor_calibration}: was made with another camera or setting ({differs}); set "
        f"the camera as it was then, and go on with: {session.resume_command}"
    )


def _identities(
    session: Session, records: list[FrameRecord]
) -> Iterator[tuple[FrameRecord, CameraIdentity]]:
    """Yield what took each frame; one that is lost or damaged is left to the reduction."""
    for record in records:
        path = session.root / record.file
        try:
            raw = decode_raw(read_vouched(path, record.sha256, ""), path, "")
        except BadFileError:
            continue
        yield record, raw.sensor.identity
