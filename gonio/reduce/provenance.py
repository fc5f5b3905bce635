"""What samples were made from, and whether that is all that a session holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.calibrationfolder import kept_calibration
from gonio.errors import BadInputError
from gonio.files import canonical_json, sha256_bytes
from gonio.reduce.color import kept_color
from gonio.reduce.poses import kept_geometry
from gonio.reference import kept_reference
from gonio.samples import Samples

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from gonio.journal import FrameRecord, Journal
    from gonio.plan import Shot
    from gonio.session import Session


def provenance_of(session: Session, used: Iterable[FrameRecord]) -> dict[str, str]:
    """Return the SHA-256 of all that samples hang on.

    That is: last plan, rig, reference table, calibration, geometry and color file, where there are
    any, and the records of the frames used.
    """
    records = sorted(used, key=lambda record: record.file)
    frames = [record.model_dump(mode="json") for record in records]
    reference, calibration = kept_reference(session), kept_calibration(session)
    geometry, color = kept_geometry(session), kept_color(session)
    return {
        "plan": session.chain().last.sha256,
        "rig": session.rig().sha256,
        "frames": sha256_bytes(canonical_json(frames)),
        **({"reference": reference.sha256} if reference else {}),
        **({"calibration": calibration.sha256} if calibration else {}),
        **({"geometry": geometry.sha256} if geometry else {}),
        **({"color": color.sha256} if color else {}),
    }


def shot_exposures(records: Iterable[FrameRecord]) -> list[float]:
    """Return the exposures in seconds that shots were taken with so far, rising.

    A plan that was added last may have others, which need no dark and white frames yet.
    """
    return sorted({record.exposure_s for record in records if record.role == "shot"})


def newest_of_shot(records: Iterable[FrameRecord], index: int) -> tuple[FrameRecord, ...]:
    """Return the newest try at each frame of a shot."""
    of_shot = [each for each in records if (each.role, each.shot_index) == ("shot", index)]
    newest = {each.key: each for each in sorted(of_shot, key=lambda each: each.attempt)}
    return tuple(newest.values())


def is_reduced(session: Session) -> bool:
    """Tell whether `samples.nc` was made from the newest try at every frame that was captured.

    So it is not when a file was missing then: it may be back. The samples may be of any patch,
    since what was reduced on purpose is not undone.
    """
    if not session.samples_path.is_file():
        return False
    try:
        made_from = Samples.load(session.samples_path).provenance
    except BadInputError:
        return False
    with session.journal() as journal:
        captured = _captured(journal, session.chain().shots)
    return made_from.items() >= provenance_of(session, captured).items()


def _captured(journal: Journal, shots: Sequence[Shot]) -> list[FrameRecord]:
    """Return the newest useful record of each calibration frame and of each whole shot's."""
    rejected, records = journal.rejected(), journal.frames()
    exposures = set(shot_exposures(records))
    useful = [
        record
        for record in records
        if record.file not in rejected and record.exposure_s in exposures
    ]
    newest = {record.key: record for record in sorted(useful, key=lambda record: record.attempt)}
    whole = {
        shot.index
        for shot in shots
        if all(("shot", shot.index, 0, exposure_s) in newest for exposure_s in shot.exposures_s)
    }
    return [
        record for record in newest.values() if record.role != "shot" or record.shot_index in whole
    ]
