"""From dark and white frames to everything that the shots are measured with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.errors import BadInputError
from gonio.materials import reference_material
from gonio.reduce.color import camera_from_srgb
from gonio.reduce.dark import mean_dark
from gonio.reduce.gain import PhotonTransfer
from gonio.reduce.reading import take_reading
from gonio.reduce.white import respond

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from gonio.journal import FrameRecord, Role
    from gonio.reduce.dark import Dark
    from gonio.reduce.frames import Frame, Frames
    from gonio.reduce.patch import PatchFinder
    from gonio.reduce.reading import Reading
    from gonio.reduce.white import Response
    from gonio.rig import Rig


@dataclass(frozen=True)
class Calibration:
    """What the dark and white frames tell.

    Attributes
    ----------
    darks
        By exposure.
    gain
        Raw units per electron.
    response
        What turns a rate into a BRDF.
    records
        The frames that it was made from.
    """

    darks: dict[float, Dark]
    gain: float
    response: Response
    records: tuple[FrameRecord, ...]


def calibrate(
    frames: Frames, rig: Rig, patches: PatchFinder, exposures_s: Sequence[float]
) -> Calibration:
    """Evaluate the dark and white frames of `exposures_s`.

    Raises
    ------
    gonio.errors.BadInputError
        When an exposure lacks dark frames, or there is no white that is neither dark nor saturated.
    """
    darks: dict[float, Dark] = {}
    records: list[FrameRecord] = []
    readings: list[Reading] = []
    transfer = PhotonTransfer()
    # exposure by exposure, so that large frames are not all held at once
    for exposure_s in exposures_s:
        dark_frames = _dark_frames(frames, exposure_s)
        white_frames = frames.of_calibration("white", exposure_s)
        dark = darks[exposure_s] = mean_dark(_mosaics(dark_frames))
        transfer.add(_mosaics(white_frames), dark, frames.sensor.saturation)
        readings += [take_reading(frame, dark, patches, rig.lamps) for frame in white_frames]
        records += [frame.record for frame in (*dark_frames, *white_frames)]
    if not readings:
        raise _lacking(frames, "white", "there is no valid white frame")
    to_camera = camera_from_srgb(frames.sensor.color_matrix)
    response = respond(readings, transfer.gain, reference_material(rig), to_camera)
    return Calibration(darks, transfer.gain, response, tuple(records))


def _mosaics(frames: Sequence[Frame]) -> list[NDArray[np.uint16]]:
    return [frame.raw.mosaic for frame in frames]


def _dark_frames(frames: Frames, exposure_s: float) -> list[Frame]:
    found = frames.of_calibration("dark", exposure_s)
    if len(found) < 2:
        problem = f"{len(found)} of at least 2 valid dark frames of {exposure_s:g} s are there"
        raise _lacking(frames, "dark", problem)
    return found


def _lacking(frames: Frames, role: Role, problem: str) -> BadInputError:
    reasons = frames.problems[role]
    return BadInputError(f"{problem}{f' ({reasons[0]})' if reasons else ''}; {frames.remedy}")
