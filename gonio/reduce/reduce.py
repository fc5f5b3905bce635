"""The reduction of a whole session: raw frames to BRDF samples."""

from __future__ import annotations

import logging
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from gonio.color import CAMERA, SPACES
from gonio.directions import normalize
from gonio.errors import BadInputError
from gonio.reduce.calibrate import calibrate
from gonio.reduce.checks import run_checks
from gonio.reduce.color import wanted_in
from gonio.reduce.correction import correction_in
from gonio.reduce.merge import merge
from gonio.reduce.opening import open_frames
from gonio.reduce.patch import PatchFinder, usual_patch_mm
from gonio.reduce.provenance import provenance_of, shot_exposures
from gonio.reduce.reading import take_reading
from gonio.reduce.stray import by_the_unhidden
from gonio.reduce.surroundings import look_around
from gonio.samples import Flag, Samples

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from numpy.typing import NDArray

    from gonio.journal import FrameRecord
    from gonio.plan import Shot
    from gonio.protocols import Progress
    from gonio.reduce.calibrate import Calibration
    from gonio.reduce.color import Coloring
    from gonio.reduce.frames import Frames
    from gonio.reduce.merge import Rate
    from gonio.reduce.reading import Reading
    from gonio.reduce.surroundings import Surroundings
    from gonio.rig import Rig
    from gonio.session import Session

_FEW_PIXELS = 8

_log = logging.getLogger(__name__)


def reduce_session(
    session: Session,
    *,
    patch_mm: float | None = None,
    space: str | None = None,
    progress: Progress | None = None,
) -> Samples:
    """Reduce a session's raw frames and write its `samples.nc` and `checks.json`.

    A shot is left out, with one warning for all, when a frame of it is missing or damaged.
    Nothing of `session/sim` is read.

    Parameters
    ----------
    session
        The session, locked by the caller.
    patch_mm
        Side of the square about the sample's centre that each sample is the mean over; without
        it, that of the samples that are there, or else `gonio.reduce.patch.usual_patch_mm`.
    space
        One of `gonio.reduce.color.CHOICES`; without it, that of the samples that are there, or
        else linear sRGB.
    progress
        Called with the number of shots done and of all.

    Raises
    ------
    gonio.errors.BadInputError
        When the session is a rehearsal, dark or white frames are lacking, or no shot can be used;
        nothing is written then.
    gonio.errors.StorageError
        When the session can only be read, or the samples cannot be written.
    """
    opened = open_frames(session)
    rig, shots, records, frames = opened.rig, opened.shots, opened.records, opened.frames
    before = _before(session)
    if patch_mm is None:
        patch_mm = (before and before.patch_mm) or usual_patch_mm(rig.camera)
    wanted = wanted_in(session, space or _space_of(before), shots)
    correction = correction_in(session.sensor_calibration)
    patches = PatchFinder(rig.camera, patch_mm, correction.bad)
    try:
        calibration = calibrate(frames, rig, patches, shot_exposures(records), correction, wanted)
    except BadInputError:
        frames.look_over()  # a resume takes all of them again
        raise
    finally:
        reject(session, frames.useless)
    rows, left_out = measure(shots, frames, patches, rig, calibration, progress)
    reject(session, frames.useless)
    warn(session, [str(error) for error in left_out.values()], len(shots), frames)
    used = [*calibration.records, *(record for row in rows for record in row.records)]
    provenance = provenance_of(session, used)
    samples = replace(samples_of(rows, calibration), provenance=provenance, patch_mm=patch_mm)
    checks = run_checks(
        _judged(rows, samples, calibration.coloring),
        left_out,
        records,
        calibration,
        rig,
        provenance["frames"],
    )
    samples = _suspected(samples, {suspect.shot for suspect in checks.suspects})
    samples.save(session.samples_path)
    checks.save(session.checks_path)
    return samples


def measure(
    shots: Sequence[Shot],
    frames: Frames,
    patches: PatchFinder,
    rig: Rig,
    calibration: Calibration,
    progress: Progress | None = None,
) -> tuple[list[Row], dict[int, BadInputError]]:
    """Return what each shot gives, and of those that cannot be used, by their index, why."""
    rows: list[Row] = []
    left_out: dict[int, BadInputError] = {}
    for done, shot in enumerate(shots, start=1):
        try:
            rows.append(_measure(shot, frames, patches, rig, calibration))
        except BadInputError as error:
            left_out[shot.index] = error
        if progress is not None:
            progress(done, len(shots))
    return rows, left_out


def _before(session: Session) -> Samples | None:
    try:
        return Samples.load(session.samples_path)
    except BadInputError:
        return None


def _space_of(samples: Samples | None) -> str | None:
    names = {space.name: option for option, space in SPACES.items()} | {CAMERA: "camera"}
    return names.get(samples.color_space) if samples else None


@dataclass(frozen=True)
class Row:
    """One sample, and what the journal says of the frames that it was made from.

    Sigma, its components and flag are known once all samples are.
    """

    shot: Shot
    records: tuple[FrameRecord, ...]
    readings: tuple[Reading, ...]
    rate: Rate
    value: NDArray[np.float64]
    around: Surroundings
    sigma: NDArray[np.float64] = field(default_factory=lambda: np.full(3, np.nan))
    components: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    flag: NDArray[np.uint32] = field(default_factory=lambda: np.zeros(3, np.uint32))

    def mean(self, name: str) -> NDArray[np.float64]:
        """Return the mean of a reading's field over the bracket."""
        return np.asarray(np.mean([getattr(reading, name) for reading in self.readings], axis=0))


def _measure(
    shot: Shot, frames: Frames, patches: PatchFinder, rig: Rig, calibration: Calibration
) -> Row:
    bracket = frames.of_shot(shot)
    read = [
        take_reading(
            frame,
            calibration.darks[frame.record.exposure_s],
            patches,
            rig,
            calibration.correction,
        )
        for frame in bracket
    ]
    readings = tuple(by_the_unhidden(read))
    rate = merge(readings, calibration.gain)
    return Row(
        shot=shot,
        records=tuple(frame.record for frame in bracket),
        readings=readings,
        rate=rate,
        value=calibration.response.brdf(rate),
        around=look_around(bracket, rig, calibration),
    )


def samples_of(rows: Sequence[Row], calibration: Calibration) -> Samples:
    """Return the samples that rows make, with their sigma by components."""
    values = _values(rows, calibration.coloring)
    rates, brackets = [row.rate for row in rows], [row.readings for row in rows]
    components = calibration.budget.components(values, rates, brackets)
    sigma = np.sqrt(sum(part**2 for part in components.values()))
    faint = np.where(values.value <= sigma, np.uint32(Flag.FAINT), np.uint32(0))
    return replace(values, sigma=sigma, flag=values.flag | faint, components=components)


def _flags(row: Row) -> NDArray[np.uint32]:
    few = np.min([reading.pixels for reading in row.readings], axis=0) < _FEW_PIXELS
    # undoing the crosstalk carries what one channel lost into all three
    clipped = np.full(row.value.shape, row.rate.clipped.any())
    return np.asarray(Flag.CLIPPED * clipped + Flag.FEW_PIXELS * few, np.uint32)


def _suspected(samples: Samples, suspects: Collection[int]) -> Samples:
    """Return the samples with the flag of those shots raised."""
    among = np.isin(samples.shot_index, list(suspects))[:, None]
    return replace(samples, flag=samples.flag | np.where(among, np.uint32(Flag.SUSPECT), 0))


def _judged(rows: Sequence[Row], samples: Samples, coloring: Coloring) -> list[Row]:
    """Return the rows with what is known of each beside the others, a white's channels all one."""
    white = coloring.white
    return [
        replace(
            row,
            value=row.value / white,
            sigma=samples.sigma[place] / white,
            components={name: part[place] / white for name, part in samples.components.items()},
            flag=samples.flag[place],
        )
        for place, row in enumerate(rows)
    ]


def _values(rows: Sequence[Row], coloring: Coloring) -> Samples:
    value = np.array([row.value for row in rows])
    return Samples(
        light=normalize([row.mean("light") for row in rows]),
        view=normalize([row.mean("view") for row in rows]),
        value=value,
        sigma=np.full(value.shape, np.nan),
        flag=np.array([_flags(row) for row in rows]),
        light_solid_angle=np.array([row.mean("light_solid_angle") for row in rows]),
        view_solid_angle=np.array([row.mean("view_solid_angle") for row in rows]),
        shot_index=np.array([row.shot.index for row in rows], np.int64),
        attempt=np.array([max(r.attempt for r in row.records) for row in rows], np.int64),
        channels=coloring.channels,
        color_space=coloring.space,
        color_made_by=coloring.made_by,
    )


def reject(session: Session, useless: Mapping[str, str]) -> None:
    """Note in the journal what is wrong with frames of no use, by file; a resume retakes them."""
    if not useless:
        return
    with session.journal(writing=True) as journal:
        known = journal.rejected()
        for file, problem in useless.items():
            if file not in known:
                journal.reject(file, problem)


def warn(session: Session, problems: Sequence[str], shots: int, frames: Frames) -> None:
    """Warn of shots and calibration frames that were left out.

    Raises
    ------
    gonio.errors.BadInputError
        When no shot is left.
    """
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
