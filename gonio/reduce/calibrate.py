"""From dark and white frames to everything that the shots are measured with."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.errors import BadInputError
from gonio.materials import reference_material
from gonio.reduce.budget import Budget
from gonio.reduce.color import Wanted
from gonio.reduce.gain import PhotonTransfer
from gonio.reduce.reading import take_reading
from gonio.reduce.stray import by_the_unhidden
from gonio.reduce.white import respond

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.journal import FrameRecord, Role
    from gonio.reduce.color import Coloring
    from gonio.reduce.correction import Correction
    from gonio.reduce.dark import Dark
    from gonio.reduce.frames import Frame, Frames
    from gonio.reduce.patch import PatchFinder
    from gonio.reduce.reading import Reading
    from gonio.reduce.white import Response
    from gonio.rig import Rig

WHITE_MM: Final = 40.0
"""Side of the square of the white reference that counts at least, with a flat field."""

_DEFAULT = Wanted()

# shares of stray light that nobody takes for one
_FAR_APART = 0.01

_log = logging.getLogger(__name__)


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
    budget
        What carries its uncertainties.
    correction
        Of the sensor.
    records
        The frames that it was made from.
    coloring
        Which space the response ends in.
    """

    darks: dict[float, Dark]
    gain: float
    response: Response
    budget: Budget
    correction: Correction
    records: tuple[FrameRecord, ...]
    coloring: Coloring


def calibrate(
    frames: Frames,
    rig: Rig,
    patches: PatchFinder,
    exposures_s: Sequence[float],
    correction: Correction,
    wanted: Wanted = _DEFAULT,
) -> Calibration:
    """Evaluate the dark and white frames of `exposures_s`, for results in the wanted space.

    Raises
    ------
    gonio.errors.BadInputError
        When an exposure lacks dark frames, there is no white that is neither dark nor saturated,
        or the space is out of reach.
    """
    darks: dict[float, Dark] = {}
    records: list[FrameRecord] = []
    readings: list[Reading] = []
    transfer = PhotonTransfer()
    # the more pixels the less noise, and all samples share what there is
    whites = patches.at_least(WHITE_MM) if correction.even else patches
    # exposure by exposure, so that large frames are not all held at once
    for exposure_s in exposures_s:
        dark_frames = _dark_frames(frames, exposure_s)
        white_frames = frames.of_calibration("white", exposure_s)
        correction.check(frames.sensor)
        dark = darks[exposure_s] = correction.dark(_mosaics(dark_frames), exposure_s)
        if correction.gain is None:
            transfer.add(_mosaics(white_frames), dark, frames.sensor.saturation)
        readings += _alike([take_reading(f, dark, whites, rig, correction) for f in white_frames])
        records += [frame.record for frame in (*dark_frames, *white_frames)]
    if not readings:
        raise _lacking(frames, "white", "there is no valid white frame")
    coloring = wanted.coloring(frames.sensor)
    gain = correction.gain or transfer.gain
    reference = coloring.shown(reference_material(rig))
    response = respond(by_the_unhidden(readings), gain, reference, coloring)
    _warn(response, rig, correction)
    budget = Budget(rig, reference, response, correction.doubt, coloring)
    return Calibration(darks, gain, response, budget, correction, tuple(records), coloring)


def _warn(response: Response, rig: Rig, correction: Correction) -> None:
    """Tell of what white frames and calibration leave open, or contradict."""
    if response.balance.lacking.any():
        _log.warning(
            "the lamps' light lacks what the camera's matrix was made for, so that sigma takes "
            "a primary for not told; shoot a chart under these lamps (gonio color)"
        )
    stated, seen = rig.camera.stray_light, correction.stray_light
    far_apart = _FAR_APART + 5.0 * correction.doubt.stray_light
    if stated and seen and abs(stated - seen) > far_apart:
        _log.warning(
            "[camera] stray_light of the rig file, %g, goes before the %.3g that the calibration "
            "saw; leave it out there unless you know better", stated, seen,
        )  # fmt: skip


def _alike(readings: Sequence[Reading]) -> list[Reading]:
    """Return repeats of one exposure, all saturated where one is: those left are the low ones."""
    if not readings:
        return []
    saturated = np.any([reading.saturated for reading in readings], axis=0)
    return [replace(reading, saturated=saturated) for reading in readings]


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
    if not reasons:
        return BadInputError(f"{problem}; {frames.remedy}")
    # a reason ends with what to do
    reason = reasons[0].removesuffix(f"; {frames.remedy}")
    remedy = f"; {frames.remedy}" if reason != reasons[0] else ""
    return BadInputError(f"{problem} ({reason}){remedy}")
