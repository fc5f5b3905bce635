"""One frame's patch in numbers: signal, exposure and directions."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import normalize
from gonio.errors import BadInputError
from gonio.reduce.correction import Uncorrected
from gonio.reduce.light import Source
from gonio.reduce.stray import stray_on

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.reduce.correction import Correction
    from gonio.reduce.dark import Dark
    from gonio.reduce.frames import Frame
    from gonio.reduce.patch import FindsPatch
    from gonio.rig import Rig


_UNCORRECTED = Uncorrected()


class UnlitError(BadInputError):
    """A frame is whole, and no light fell on the sample meanwhile."""


@dataclass(frozen=True)
class Reading:
    """What a frame says about the patch, channel by channel (camera RGB).

    Attributes
    ----------
    signal
        Mean above dark and stray light, in raw units of a linear sensor, shape (3,).
    exposure
        Mean irradiance x time x the pixels' response, in s/mm2 (see `gonio.reduce.light.Source`),
        shape (3,).
    pixels
        How many pixels, as `gonio.reduce.patch.Patch` counts them, shape (3,).
    saturated
        Whether any of them was, shape (3,).
    read_variance, dark_variance
        Of one pixel of a frame without light, and of the mean dark frame, in raw units squared.
    surround
        Mean above dark over the whole frame, in raw units of a linear sensor, shape (3,); 0 where
        neither rig file nor calibration tells of stray light.
    around
        Mean above dark about the patch that a halo spreads its share of, less the veil, in the same
        unit, shape (3,); 0 where none is known.
    stray
        What was taken off as stray light and halo, in raw units, shape (3,).
    light, view
        Unit vectors, shape (3,): means over the patch.
    arms_rad
        Theta and phi of light and view by the encoders, shape (4,): a direction at the pole tells
        no phi.
    light_solid_angle, view_solid_angle
        In sr.
    hidden
        Share of the frame's pixels that are saturated; 0 where nothing tells of stray light.
    exposure_s
        What the shutter was asked for.
    flux
        Of lamps 1 to 11, shape (11,).
    as_read
        Mean above dark before the bending is undone, stray light included, shape (3,).
    """

    signal: NDArray[np.float64]
    exposure: NDArray[np.float64]
    pixels: NDArray[np.float64]
    saturated: NDArray[np.bool_]
    read_variance: float
    dark_variance: float
    surround: NDArray[np.float64]
    stray: NDArray[np.float64]
    light: NDArray[np.float64]
    view: NDArray[np.float64]
    arms_rad: NDArray[np.float64]
    light_solid_angle: float
    view_solid_angle: float
    exposure_s: float = 1.0
    flux: NDArray[np.float64] = field(default_factory=lambda: np.ones(11))
    as_read: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    hidden: float = 0.0
    around: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))

    @property
    def lamps(self) -> NDArray[np.float64]:
        """Each lamp's share of the light, shape (11,)."""
        return np.asarray(self.flux / self.flux.sum())


def take_reading(
    frame: Frame,
    dark: Dark,
    patches: FindsPatch,
    rig: Rig,
    correction: Correction = _UNCORRECTED,
) -> Reading:
    """Read the patch of a frame.

    The pixels' response counts with the exposure instead of being divided out pixel by pixel: sums
    of signals over sums of exposures have the least photon noise. A share g of stray light leaves
    (1 - g) of the image where it was; that factor is in the white frames, too, and cancels, as does
    that of a halo.

    Raises
    ------
    UnlitError
        When no light fell on it.
    gonio.errors.BadInputError
        When the patch is out of sight.
    """
    sensor = frame.raw.sensor
    flux = correction.flux(frame.record.flux)
    source = Source(rig.lamps, frame.light, flux)
    patch = patches.find(frame.view, sensor)
    answered = patch.of(correction.response(sensor)) * source.irradiance(patch.points_mm)
    exposure = frame.raw.exposure_s * patch.mean(answered)
    if not exposure.all():
        raise UnlitError(
            f"{frame.record.file}: no light fell on the sample (light at "
            f"{frame.record.light_theta_deg:.1f} deg, lamps {sum(frame.record.flux):.5f}); "
            "check the lamps and capture again"
        )
    raw, stray = patch.of(frame.raw.mosaic), stray_on(patch, frame.raw, dark, rig, correction)
    as_read = raw - patch.of(dark.mean)
    return Reading(
        signal=patch.mean(correction.linear(as_read)) - stray.taken,
        exposure=exposure,
        pixels=patch.pixels,
        saturated=patch.any(raw >= correction.saturation(sensor)),
        read_variance=dark.read_variance,
        dark_variance=dark.mean_variance,
        surround=stray.surround,
        around=stray.around,
        stray=stray.taken,
        hidden=stray.hidden,
        light=normalize(source.directions(patch.points_mm).mean(axis=0)),
        view=patch.view,
        arms_rad=np.array([a for arm in (frame.light, frame.view) for a in (arm.theta, arm.phi)]),
        light_solid_angle=source.solid_angle,
        view_solid_angle=patch.solid_angle,
        exposure_s=frame.record.exposure_s,
        flux=np.asarray(flux, np.float64),
        as_read=patch.mean(as_read),
    )
