"""Each shot's bracket as one picture of light, for whoever wants more than a patch of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from gonio.files import write_with
from gonio.reduce.calibrate import calibrate
from gonio.reduce.correction import Uncorrected, correction_in
from gonio.reduce.hdr import Exposed, Pixels, merge_pixels
from gonio.reduce.opening import open_frames
from gonio.reduce.patch import PatchFinder, usual_patch_mm
from gonio.reduce.provenance import shot_exposures

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.protocols import Progress
    from gonio.reduce.calibrate import Calibration
    from gonio.reduce.dark import Dark
    from gonio.reduce.frames import Frame
    from gonio.reduce.hdr import Radiance
    from gonio.reduce.raw import Sensor
    from gonio.session import Session


def write_radiance(session: Session, folder: Path, progress: Progress | None = None) -> int:
    """Merge every whole shot of a session, pixel by pixel, into `shot_<index>.npz`.

    Parameters
    ----------
    session
        The session, locked by the caller.
    folder
        Where they go; files of the same names are replaced.
    progress
        Called with the number of shots done and of all.

    Returns
    -------
    int
        How many shots were written; those with a missing or damaged frame are not.

    Raises
    ------
    gonio.errors.BadInputError
        As `gonio.reduce.reduce_session`.
    gonio.errors.StorageError
        When a file cannot be written.
    """
    opened = open_frames(session)
    rig, frames, exposures_s = opened.rig, opened.frames, shot_exposures(opened.records)
    correction = correction_in(session.sensor_calibration)
    patches = PatchFinder(rig.camera, usual_patch_mm(rig.camera), correction.bad)
    calibration = calibrate(frames, rig, patches, exposures_s, correction)
    pixels, written = pixels_of(calibration, frames.sensor), 0
    for done, shot in enumerate(opened.shots, start=1):
        if progress is not None:
            progress(done, len(opened.shots))
        try:
            bracket = frames.of_shot(shot)
        except BadInputError:
            continue
        shown = [
            exposed(frame, calibration.darks[frame.record.exposure_s], frame.raw.exposure_s)
            for frame in bracket
        ]
        merged = merge_pixels(shown, pixels)
        _save(merged, folder / f"shot_{shot.index:06d}.npz")
        written += 1
    return written


def exposed(
    frame: Frame, dark: Dark, exposure: float, stray: NDArray[np.float64] | None = None
) -> Exposed:
    """Return a frame for the merge.

    Parameters
    ----------
    frame, dark
        The frame, and what is taken off it.
    exposure
        See `gonio.reduce.hdr.Exposed`.
    stray
        Light that lies over all of the frame, in raw units of a linear sensor, shape (3,).
    """
    stray = np.zeros(3) if stray is None else stray
    one, two, three, four = (float(stray["RGB".index(c)]) for c in frame.raw.sensor.pattern)
    return Exposed(
        mosaic=frame.raw.mosaic,
        dark=dark.mean.astype(np.float32, copy=False),
        exposure=exposure,
        read_variance=dark.read_variance + dark.mean_variance,
        stray=(one, two, three, four),
    )


def pixels_of(calibration: Calibration, sensor: Sensor) -> Pixels:
    """Return what makes raw values of light, by the calibration."""
    correction, response = calibration.correction, None
    if not isinstance(correction, Uncorrected):
        response = correction.response(sensor).astype(np.float32)
        response[correction.bad] = np.nan
    return Pixels(calibration.gain, correction.saturation(sensor), correction.linearity, response)


def _save(merged: Radiance, path: Path) -> None:
    def write(aside: Path) -> None:
        with aside.open("wb") as file:
            np.savez_compressed(
                file,
                radiance=merged.value,
                variance=merged.variance,
                clipped=merged.clipped,
            )

    write_with(path, write)
