"""The holder's white squares in a frame: a target that is always there and never changes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.camera import Camera
from gonio.geometry import SAMPLE_SIDE_MM
from gonio.reduce.light import Source

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.geometry import ArmPose
    from gonio.reduce.correction import Correction
    from gonio.reduce.dark import Dark
    from gonio.reduce.frames import Frame
    from gonio.rig import CameraSpec, Rig

_SQUARES: Final = 13
_CUT_OUT: Final = 7
_SQUARE_MM: Final = 10.0
# around the marker of a white square its paper is 1.5 mm wide
_MIDDLE_MM: Final = 0.75
_FROM_CORNER_MM: Final = 3.0
_FROM_SAMPLE_MM: Final = 2.5
_FEWEST = 20
_GREEN = 1


@dataclass(frozen=True)
class HolderLevel:
    """How bright the white squares are.

    Attributes
    ----------
    level
        Mean green signal over exposure, in the unit of `gonio.reduce.merge.Rate`: constant but for
        how the paper's BRDF depends on the directions.
    sigma
        Of that, by the noise of photons and of reading.
    """

    level: float
    sigma: float


def holder_level(
    frame: Frame, dark: Dark, gain: float, rig: Rig, correction: Correction
) -> HolderLevel | None:
    """Return how bright a frame's white squares are.

    Looked at are the middles of the paper around the markers, where a pixel lies within the paper.

    Parameters
    ----------
    frame, dark
        The frame, and the dark frames of its exposure.
    gain
        Raw units per electron.
    rig
        Its camera and lamps.
    correction
        Of the sensor.

    Returns
    -------
    HolderLevel or None
        None where too few are seen, the light is below the plane, or one is saturated.
    """
    sensor = frame.raw.sensor
    points, pixels = _seen(rig.camera, frame.view)
    if len(points):
        usable = sensor.channel(pixels[:, 1], pixels[:, 0]) == _GREEN
        if correction.bad is not None:
            usable &= ~correction.bad[pixels[:, 1], pixels[:, 0]]
        points, pixels = points[usable], pixels[usable]
    flux = correction.flux(frame.record.flux)
    light = Source(rig.lamps, frame.light, flux).irradiance(points)
    if len(points) < _FEWEST or not light.all():
        return None
    at = pixels[:, 1], pixels[:, 0]
    raw = frame.raw.mosaic[at]
    if (raw >= correction.saturation(sensor)).any():
        return None
    signal = correction.linear(raw - dark.mean[at])
    exposure = frame.raw.exposure_s * light * correction.response(sensor)[at]
    variance = gain * max(float(signal.mean()), 0.0) + (dark.read_variance + dark.mean_variance)
    sigma = float(np.sqrt(variance * (exposure**-2.0).sum())) / len(signal)
    return HolderLevel(float((signal / exposure).mean()), sigma)


def _seen(spec: CameraSpec, pose: ArmPose) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return points in mm, shape (n, 3), and the pixels (column, row) that see nothing else."""
    points, room = _paper()
    camera = Camera(spec)
    place = camera.project(points, pose)
    pixels = np.round(place).astype(np.intp)
    inside = ((pixels >= 0) & (pixels < (spec.width, spec.height))).all(axis=1)
    points, room, place, pixels = points[inside], room[inside], place[inside], pixels[inside]
    if not len(points):
        return points, pixels
    columns = [camera.project(points + way, pose) - place for way in np.eye(3)[:2]]
    mm_per_px = np.linalg.inv(np.stack(columns, axis=-1))
    # how far off a pixel's middle is, and how far from there it reaches
    off = np.abs((mm_per_px @ (pixels - place)[..., None])[..., 0])
    reach = off + 0.5 * np.abs(mm_per_px).sum(axis=-1)
    seen = (reach <= room).all(axis=1)
    return points[seen], pixels[seen]


@lru_cache(maxsize=1)
def _paper() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return points in the middle of the paper around markers, and the room about each, in mm.

    Shapes (n, 3) and (n, 2), the room along x and along y.
    """
    along = np.linspace(_FROM_CORNER_MM, _SQUARE_MM - _FROM_CORNER_MM, 9)
    edges = (_MIDDLE_MM, _SQUARE_MM - _MIDDLE_MM)
    ring = [(x, y, _MIDDLE_MM, _FROM_CORNER_MM) for x in edges for y in along]
    ring += [(x, y, _FROM_CORNER_MM, _MIDDLE_MM) for x in along for y in edges]
    half, cut = _SQUARES / 2, range((_SQUARES - _CUT_OUT) // 2, (_SQUARES + _CUT_OUT) // 2)
    rows = [
        (_SQUARE_MM * (column - half) + x, _SQUARE_MM * (half - row) - y, *room)
        for row in range(_SQUARES)
        for column in range(_SQUARES)
        # the first square is black
        if (row + column) % 2 and not (row in cut and column in cut)
        for x, y, *room in ring
    ]
    table = np.array(rows)
    # beside the sample, lens and angles of a few hundredths would let its highlights in
    table = table[np.abs(table[:, :2]).max(axis=1) > SAMPLE_SIDE_MM / 2.0 + _FROM_SAMPLE_MM]
    flat = np.zeros((len(table), 1))
    return np.hstack([table[:, :2], flat]), table[:, 2:]
