"""A session's frames, opened to be reduced."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.calibrationfolder import kept_calibration
from gonio.errors import BadInputError
from gonio.reduce.frames import Frames
from gonio.reduce.poses import kept_geometry
from gonio.reference import rig_with_reference

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.journal import FrameRecord
    from gonio.photogrammetry.geometry_file import Geometry
    from gonio.plan import Shot
    from gonio.rig import Rig
    from gonio.session import Session


@dataclass(frozen=True)
class Opened:
    """What a reduction starts from.

    Attributes
    ----------
    rig
        With the white reference that the session keeps, and the camera as it was measured.
    shots
        Of all plans.
    records
        The journal's frames, oldest first.
    frames
        These, to be read.
    geometry
        Camera and view arm as measured, where they were; the rig's camera goes by it.
    """

    rig: Rig
    shots: Sequence[Shot]
    records: Sequence[FrameRecord]
    frames: Frames
    geometry: Geometry | None


def open_frames(session: Session) -> Opened:
    """Return what a session has to be reduced.

    Raises
    ------
    gonio.errors.BadInputError
        When the session is a rehearsal, or has no shot yet.
    gonio.errors.StorageError
        When the session can only be read.
    """
    session.check_writable("copy it to a folder that can be written, and reduce the copy")
    if session.notes().rehearsal:
        raise BadInputError(
            f"{session.root}: is a rehearsal, whose frames show nothing; measure with gonio "
            "capture, without --rehearse and into another folder"
        )
    rig, shots = rig_with_reference(session), session.chain().shots
    if geometry := kept_geometry(session):
        rig = rig.model_copy(update={"camera": geometry.camera(rig.camera).spec})
    records = records_of(session)
    if not any(record.role == "shot" for record in records):
        raise BadInputError(
            f"{session.root}: no shot has been captured yet; go on with: {session.resume_command}"
        )
    remedy = f"take it again with: {session.resume_command}"
    calibration = kept_calibration(session)
    camera = calibration.camera if calibration else None
    frames = Frames(session.root, rig.camera, records, remedy, geometry, calibrated=camera)
    return Opened(rig, shots, records, frames, geometry)


def records_of(session: Session) -> list[FrameRecord]:
    """Return the journal's frames, oldest first, without those that it rejects."""
    with session.journal() as journal:
        rejected = journal.rejected()
        return [record for record in journal.frames() if record.file not in rejected]
