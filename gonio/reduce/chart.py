"""A session whose sample is a color chart: what the camera's channels say of each patch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.camera import Camera
from gonio.chart import PATCHES, patch_names
from gonio.colorimetry.color_file import lit_lamps
from gonio.colorimetry.detection import at_corners, find_chart, patch_numbers
from gonio.directions import normalize
from gonio.errors import BadInputError
from gonio.files import canonical_json, sha256_bytes
from gonio.geometry import SAMPLE_SIDE_MM
from gonio.reduce.calibrate import calibrate
from gonio.reduce.color import Wanted
from gonio.reduce.correction import correction_in
from gonio.reduce.merge import merge
from gonio.reduce.opening import open_frames
from gonio.reduce.patch import Patch, PatchFinder, usual_patch_mm
from gonio.reduce.picture import best_exposed, color_picture_of
from gonio.reduce.provenance import shot_exposures
from gonio.reduce.reading import take_reading
from gonio.reduce.stray import by_the_unhidden

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.geometry import ArmPose
    from gonio.journal import FrameRecord
    from gonio.plan import Shot
    from gonio.protocols import Progress
    from gonio.reduce.calibrate import Calibration
    from gonio.reduce.frames import Frame
    from gonio.reduce.merge import Rate
    from gonio.reduce.raw import RawFrame, Sensor
    from gonio.rig import Rig
    from gonio.session import Session

Corners = tuple[tuple[float, float], ...]

_FEW_PIXELS = 8
_GREEN = 1
# of each side of the frame: the chart, and not the white paper around it
_MIDDLE = 0.5
_MM_PER_M = 1000.0


@dataclass(frozen=True)
class ChartReading:
    """What the shots of a chart say.

    Attributes
    ----------
    factor, sigma
        Reflectance factor of the patches in white-balanced camera RGB and its noise, shape (24, 3).
    white, white_sigma
        What the channels, not balanced, say of white, green's as 1, and the relative noise of that,
        which all patches share, shape (3,).
    lamps
        The numbers of those that were lit.
    raw, homography
        A frame, and where the chart is in it (see `gonio.colorimetry.detection.find_chart`).
    frames_sha256
        Of the journal's records of all frames used.
    """

    factor: NDArray[np.float64]
    sigma: NDArray[np.float64]
    white: NDArray[np.float64]
    white_sigma: NDArray[np.float64]
    lamps: tuple[int, ...]
    raw: RawFrame
    homography: NDArray[np.float64]
    frames_sha256: str


def read_chart(
    session: Session, corners_px: Corners | None = None, progress: Progress | None = None
) -> ChartReading:
    """Read the patches of a chart in the holder against the white reference, mean of all shots.

    Parameters
    ----------
    session
        Whose sample is the chart, locked by the caller.
    corners_px
        Where the corner patches are (see `gonio.colorimetry.detection.at_corners`); by default the
        chart is found in each shot.
    progress
        Called with the number of shots done and of all.

    Raises
    ------
    gonio.errors.BadInputError
        When a frame is missing or damaged, no chart is found, a patch has too few pixels or is
        saturated in every exposure, or shots differ in their lamps.
    """
    opened = open_frames(session)
    lamps = lit_lamps([[lamp.n for lamp in shot.lamps] for shot in opened.shots])
    poses = {(shot.view_theta_deg, shot.view_phi_deg) for shot in opened.shots}
    if corners_px and len(poses) > 1:
        raise BadInputError(
            f"--corners are of one pose of the camera, and {session.root} has {len(poses)}; leave "
            "the option out, or plan a single view"
        )
    correction = correction_in(session.sensor_calibration)
    patches = PatchFinder(opened.rig.camera, usual_patch_mm(opened.rig.camera), correction.bad)
    exposures_s = shot_exposures(opened.records)
    calibration = calibrate(
        opened.frames, opened.rig, patches, exposures_s, correction, Wanted("camera")
    )
    seen = []
    for done, shot in enumerate(opened.shots, start=1):
        bracket = opened.frames.of_shot(shot)
        seen.append(_ChartShot.of(shot, bracket, corners_px, opened.rig, calibration))
        if progress is not None:
            progress(done, len(opened.shots))
    return _together(seen, calibration, lamps)


def _together(
    seen: Sequence[_ChartShot], calibration: Calibration, lamps: tuple[int, ...]
) -> ChartReading:
    response = calibration.response
    scale = np.pi / response.rate_per_brdf
    factors = scale * np.array([[rate.value for rate in shot.rates] for shot in seen])
    variances = scale**2 * np.array([[rate.variance for rate in shot.rates] for shot in seen])
    used = [*calibration.records, *(record for shot in seen for record in shot.records)]
    plain = [each.model_dump(mode="json") for each in sorted(used, key=lambda each: each.file)]
    return ChartReading(
        factor=factors.mean(axis=0),
        sigma=np.sqrt(variances.sum(axis=0)) / len(seen),
        white=response.rate_per_brdf / response.rate_per_brdf[_GREEN],
        white_sigma=np.sqrt(response.rate.variance) / response.rate.value,
        lamps=lamps,
        raw=seen[0].raw,
        homography=seen[0].homography,
        frames_sha256=sha256_bytes(canonical_json(plain)),
    )


@dataclass(frozen=True)
class _ChartShot:
    """One shot: each patch's rate, from its whole bracket."""

    rates: tuple[Rate, ...]
    records: tuple[FrameRecord, ...]
    raw: RawFrame
    homography: NDArray[np.float64]

    @classmethod
    def of(
        cls,
        shot: Shot,
        bracket: Sequence[Frame],
        corners_px: Corners | None,
        rig: Rig,
        calibration: Calibration,
    ) -> _ChartShot:
        best = best_exposed(bracket, _MIDDLE)
        try:
            homography = at_corners(corners_px) if corners_px else _found(best, rig)
            areas = _areas(homography, best, rig, calibration.correction.bad)
        except BadInputError as error:
            raise BadInputError(f"shot {shot.index}: {error}") from None
        rates = tuple(_rate(area, bracket, rig, calibration) for area in areas)
        for name, rate in zip(patch_names(), rates, strict=True):
            if rate.clipped.any():
                raise BadInputError(
                    f"shot {shot.index}: patch {name} is saturated in every exposure; add a "
                    "shorter one to camera.exposures_s"
                )
        records = tuple(frame.record for frame in bracket)
        return cls(rates, records, best.raw, homography)


def _found(frame: Frame, rig: Rig) -> NDArray[np.float64]:
    """Find the chart in the holder's opening: the board's squares around it look like patches."""
    picture = color_picture_of(frame.raw)
    points = Camera(rig.camera).plane_points(frame.view)[::2, ::2][: len(picture)]
    reach = np.abs(points[:, : picture.shape[1]]).max(axis=-1, keepdims=True)
    try:
        return find_chart(np.where(reach <= SAMPLE_SIDE_MM / 2.0, picture, 0).astype(np.uint8))
    except BadInputError:
        # one that is larger than a sample lies on the board
        return find_chart(picture)


def _rate(area: _Area, bracket: Sequence[Frame], rig: Rig, calibration: Calibration) -> Rate:
    darks, correction = calibration.darks, calibration.correction
    readings = [
        take_reading(frame, darks[frame.record.exposure_s], area, rig, correction)
        for frame in bracket
    ]
    return merge(by_the_unhidden(readings), calibration.gain)


@dataclass(frozen=True)
class _Area:
    """Finds the same pixels in every frame, which a patch of the chart is read from."""

    patch: Patch

    def find(self, _pose: ArmPose, _sensor: Sensor) -> Patch:
        """Return them (see `gonio.reduce.patch.PatchFinder`)."""
        return self.patch


def _areas(
    homography: NDArray[np.float64], frame: Frame, rig: Rig, bad: NDArray[np.bool_] | None
) -> list[_Area]:
    sensor = frame.raw.sensor
    numbers = patch_numbers(homography, sensor.height, sensor.width)
    if bad is not None:
        numbers[bad] = -1
    points = Camera(rig.camera).plane_points(frame.view)
    eye = frame.view.place(_MM_PER_M * rig.camera.distance_m)
    areas = []
    for number in range(PATCHES):
        rows, columns = np.nonzero(numbers == number)
        channel = sensor.channel(rows, columns)
        if np.bincount(channel, minlength=3).min() < _FEW_PIXELS:
            raise BadInputError(
                f"patch {patch_names()[number]} has fewer than {_FEW_PIXELS} pixels of a color; "
                "check that the whole chart is seen, or use a larger chart or sensor"
            )
        where = points[rows, columns]
        view = normalize(normalize(eye - where).mean(axis=0))
        areas.append(_Area(Patch(rows, columns, channel, where, view, 0.0)))
    return areas
