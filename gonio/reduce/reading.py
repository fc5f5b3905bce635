"""One frame's patch in numbers: signal, exposure and directions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import normalize
from gonio.errors import BadInputError
from gonio.reduce.light import Source

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.reduce.dark import Dark
    from gonio.reduce.frames import Frame
    from gonio.reduce.patch import PatchFinder
    from gonio.rig import Lamps


@dataclass(frozen=True)
class Reading:
    """What a frame says about the patch, channel by channel (camera RGB).

    Attributes
    ----------
    signal
        Mean above dark, in raw units, shape (3,).
    exposure
        Mean irradiance x time, in s/mm2 (see `gonio.reduce.light.Source`), shape (3,).
    pixels
        How many pixels, shape (3,).
    saturated
        Whether any of them was, shape (3,).
    read_variance
        Of one pixel without light, dark frame included, in raw units squared.
    light, view
        Unit vectors, shape (3,): means over the patch.
    light_solid_angle, view_solid_angle
        In sr.
    """

    signal: NDArray[np.float64]
    exposure: NDArray[np.float64]
    pixels: NDArray[np.intp]
    saturated: NDArray[np.bool_]
    read_variance: float
    light: NDArray[np.float64]
    view: NDArray[np.float64]
    light_solid_angle: float
    view_solid_angle: float


def take_reading(frame: Frame, dark: Dark, patches: PatchFinder, lamps: Lamps) -> Reading:
    """Read the patch of a frame.

    Raises
    ------
    gonio.errors.BadInputError
        When the patch is out of sight or in the dark.
    """
    sensor, source = frame.raw.sensor, Source(lamps, frame.light, frame.record.flux)
    patch = patches.find(frame.view, sensor)
    exposure = frame.raw.exposure_s * patch.mean(source.irradiance(patch.points_mm))
    if not exposure.all():
        raise BadInputError(
            f"{frame.record.file}: no light fell on the sample (light at "
            f"{frame.record.light_theta_deg:.1f} deg, lamps {sum(frame.record.flux):.5f}); "
            "check the lamps and capture again"
        )
    raw = patch.of(frame.raw.mosaic)
    return Reading(
        signal=patch.mean(raw - patch.of(dark.mean)),
        exposure=exposure,
        pixels=patch.pixels,
        saturated=patch.mean((raw >= sensor.saturation).astype(np.float64)) > 0,
        read_variance=dark.pixel_variance,
        light=normalize(source.directions(patch.points_mm).mean(axis=0)),
        view=patch.view,
        light_solid_angle=source.solid_angle,
        view_solid_angle=patch.solid_angle,
    )
