"""The reduction of a whole session: raw frames to BRDF samples."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.directions import normalize
from gonio.errors import BadInputError
from gonio.reduce.calibrate import calibrate
from gonio.reduce.color import COLOR_SPACE
from gonio.reduce.frames import Frames
from gonio.reduce.merge import merge
from gonio.reduce.patch import PatchFinder
from gonio.reduce.provenance import provenance_of, shot_exposures
from gonio.reduce.reading import take_reading
from gonio.reference import rig_with_reference
from gonio.samples import Flag, Samples

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.journal import FrameRecord
    from gonio.plan import Shot
    from gonio.protocols import Progress
    from gonio.reduce.calibrate import Calibration
    from gonio.reduce.merge import Rate
    from gonio.reduce.reading import Reading
    from gonio.rig import Rig
    from gonio.session import Session

PATCH_MM: Final = 5.0
"""Side of the patch that a sample is the mean over, unless it was ever told otherwise."""

_FEW_PIXELS = 8

_log = logging.getLogger(__name__)


def reduce_session(
    session: Session, *, patch_mm: float | None = None, progress: Progress | None = None
) -> Samples:
    """Reduce a session's raw frames and write its `samples.nc`.

    A shot is left out, with one warning for all, when a frame of it is missing or damaged.
    Nothing of `session/sim` is read.

    Parameters
    ----------
    session
        The session, locked by the caller.
    patch_mm
        Side of the square about the sample's centre that each sample is the mean over; without
        it, that of the samples that are there, or else `PATCH_MM`.
    progress
        Called with the number of shots done and of all.

    Raises
    ------
    gonio.errors.BadInputError
        When dark or white frames are lacking, or no shot can be used; nothing is written then.
    gonio.errors.StorageError
        When the session can only be read, or the samples cannot be written.
    """
    session.check_writable("copy it to a folder that can be written, and reduce the copy")
    rig, shots = rig_with_reference(session), session.chain().shots
    with session.journal() as journal:
        records = journal.frames()
    if not any(record.role == "shot" for record in records):
        raise BadInputError(
            f"{session.root}: no shot has been captured yet; go on with: {session.resume_command}"
        )
    remedy = f"take it again with: {session.resume_command}"
    frames = Frames(session.root, rig.camera, records, remedy)
    patch_mm = _patch_before(session) if patch_mm is None else patch_mm
    patches = PatchFinder(rig.camera, patch_mm)
    try:
        calibration = calibrate(frames, rig, patches, shot_exposures(records))
    finally:
        _reject(session, frames)
    rows, problems = [], []
    for done, shot in enumerate(shots, start=1):
        try:
            rows.append(_measure(shot, frames, patches, rig, calibration))
        except BadInputError as error:
            problems.append(str(error))
        if progress is not None:
            progress(done, len(shots))
    _reject(session, frames)
    _warn(session, problems, len(shots), frames)
    used = [*calibration.records, *(record for row in rows for record in row.records)]
    samples = _samples(rows, provenance_of(session, used), patch_mm)
    samples.save(session.samples_path)
    return samples


def _patch_before(session: Session) -> float:
    try:
        return Samples.load(session.samples_path).patch_mm or PATCH_MM
    except BadInputError:
        return PATCH_MM


@dataclass(frozen=True)
class _Row:
    """One sample, and what the journal says of the frames that it was made from."""

    shot: Shot
    records: tuple[FrameRecord, ...]
    readings: tuple[Reading, ...]
    value: NDArray[np.float64]
    sigma: NDArray[np.float64]
    flag: NDArray[np.uint32]

    def mean(self, name: str) -> NDArray[np.float64]:
        """Return the mean of a reading's field over the bracket."""
        return np.asarray(np.mean([getattr(reading, name) for reading in self.readings], axis=0))


def _measure(
    shot: Shot, frames: Frames, patches: PatchFinder, rig: Rig, calibration: Calibration
) -> _Row:
    bracket = frames.of_shot(shot)
    readings = tuple(
        take_reading(frame, calibration.darks[frame.record.exposure_s], patches, rig.lamps)
        for frame in bracket
    )
    rate = merge(readings, calibration.gain)
    value, sigma = calibration.response.brdf(rate)
    return _Row(
        shot=shot,
        records=tuple(frame.record for frame in bracket),
        readings=readings,
        value=value,
        sigma=sigma,
        flag=_flags(value, sigma, rate, readings),
    )


def _flags(
    value: NDArray[np.float64],
    sigma: NDArray[np.float64],
    rate: Rate,
    readings: Sequence[Reading],
) -> NDArray[np.uint32]:
    few = np.min([reading.pixels for reading in readings], axis=0) < _FEW_PIXELS
    # undoing the crosstalk carries what one channel lost into all three
    clipped = np.full(value.shape, rate.clipped.any())
    bits = Flag.CLIPPED * clipped + Flag.FAINT * (value <= sigma) + Flag.FEW_PIXELS * few
    return np.asarray(bits, np.uint32)


def _samples(rows: Sequence[_Row], provenance: dict[str, str], patch_mm: float) -> Samples:
    return Samples(
        light=normalize([row.mean("light") for row in rows]),
        view=normalize([row.mean("view") for row in rows]),
        value=np.array([row.value for row in rows]),
        sigma=np.array([row.sigma for row in rows]),
        flag=np.array([row.flag for row in rows]),
        light_solid_angle=np.array([row.mean("light_solid_angle") for row in rows]),
        view_solid_angle=np.array([row.mean("view_solid_angle") for row in rows]),
        shot_index=np.array([row.shot.index for row in rows], np.int64),
        attempt=np.array([max(r.attempt for r in row.records) for row in rows], np.int64),
        color_space=COLOR_SPACE,
        provenance=provenance,
        patch_mm=patch_mm,
    )


def _reject(session: Session, frames: Frames) -> None:
    if not frames.useless:
        return
    with session.journal(writing=True) as journal:
        known = journal.rejected()
        for file, problem in frames.useless.items():
            if file not in known:
                journal.reject(file, problem)


def _warn(session: Session, problems: Sequence[str], shots: int, frames: Frames) -> None:
    if len(problems) == shots:
        raise BadInputError(
            f"{session.root}: none of the {shots} shots can be used, the first because of "
            f"{problems[0]}"
        )
    if problems:
        _log.warning(
            "%s: %d of %d shots left out, the first because of %s",
            session.root, len(problems), shots, problems[0],
        )  # fmt: skip
    lost = [problem for role in frames.problems.values() for problem in role]
    if lost:
        _log.warning(
            "%s: %d calibration frames left out, the first because of %s",
            session.root, len(lost), lost[0],
        )  # fmt: skip
