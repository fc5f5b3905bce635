"""The uncertainty budget: each cause carried through the measurement equation (GUM)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.reduce.causes import Causes
from gonio.reduce.slope import misfit, smooth_fit
from gonio.reduce.tolerance import axis_effects, missed_effects, seat_effects

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.protocols import Material
    from gonio.reduce.color import Coloring
    from gonio.reduce.doubt import Doubt
    from gonio.reduce.merge import Rate
    from gonio.reduce.reading import Reading
    from gonio.reduce.white import Response
    from gonio.rig import Rig
    from gonio.samples import Samples

    Array = NDArray[np.float64]

_MM_PER_M = 1000.0


@dataclass(frozen=True)
class Budget:
    """Carries uncertainties from the camera's channels to samples.

    The law of propagation, JCGM 100:2008 (GUM) equations 10 and 13: squares of independent causes
    add up; a cause that two inputs share is carried with its sign through both before it is
    squared, so the zero of an axis, the black level and stray light partly cancel against the
    white reference.

    Attributes
    ----------
    rig
        Its `uncertainty` is what is stated.
    reference
        The white reference, in the space of the results.
    response
        What the white frames told.
    doubt
        How well the sensor's correction is known.
    coloring
        How camera channels become the space.
    """

    rig: Rig
    reference: Material
    response: Response
    doubt: Doubt
    coloring: Coloring

    def components(
        self, samples: Samples, rates: Sequence[Rate], brackets: Sequence[Sequence[Reading]]
    ) -> dict[str, Array]:
        """Return standard uncertainties in 1/sr, shape (n, 3), by `gonio.uncertainty.COMPONENTS`.

        Parameters
        ----------
        samples
            Directions and values; their sigma is not read.
        rates, brackets
            What each value was made from.
        """
        stated, response = self.rig.uncertainty, self.response
        causes = Causes(response, samples.value, rates, brackets, self.doubt)
        flux, flux_of_white = causes.frame_by_frame()
        angle, alignment = self._geometry(samples, brackets)
        level = stated.black_level_dn * causes.common("level")
        white_flux = stated.flux_monitor * flux_of_white * samples.value
        return {
            "photon": causes.independent("photon"),
            "read": causes.independent("read"),
            "dark": np.hypot(causes.independent("dark"), level),
            "white": np.hypot(causes.white_noise(), white_flux),
            "calibration": causes.calibration(),
            "color": self._color(causes),
            "shutter": stated.shutter * causes.shutter(),
            "flux": stated.flux_monitor * flux,
            "angle": angle,
            "alignment": alignment,
            "stray": np.hypot(
                self._stray_light * causes.common("surround"),
                self.doubt.halo * causes.common("around"),
            ),
            "reference": np.abs(stated.reference * samples.value),
        }

    @property
    def _stray_light(self) -> float:
        """What the rig file states, unless it takes the share as the calibration saw it."""
        stated = self.rig.uncertainty.stray_light
        return (
            stated
            if self.rig.camera.stray_light
            else float(np.hypot(stated, self.doubt.stray_light))
        )

    def _color(self, causes: Causes) -> Array:
        """Return what colors of lamps and matrix leave open, shape (n, 3)."""
        model = self.response.balance.model_sigma(causes.value)
        matrix = np.einsum("kij,nj->kni", self.coloring.errors, causes.camera)
        drift = self.rig.uncertainty.lamp_color * causes.fading()[:, None] * causes.value
        return np.asarray(np.sqrt(model**2 + (matrix**2).sum(axis=0) + drift**2))

    def _geometry(
        self, samples: Samples, brackets: Sequence[Sequence[Reading]]
    ) -> tuple[Array, Array]:
        """Return the components angle and alignment, each of shape (n, 3)."""
        stated = self.rig.uncertainty
        if not (stated.angle_deg or stated.tilt_deg or stated.height_mm):
            return np.zeros(samples.value.shape), np.zeros(samples.value.shape)
        arms = np.array([_arms(bracket) for bracket in brackets])
        fit = smooth_fit(samples)
        angle, seat = self._effects(fit, arms, samples.light, samples.view)
        missed = samples.value * missed_effects(
            misfit(samples, fit), arms, float(np.radians(stated.angle_deg))
        )
        white = np.atleast_2d(
            _arms(self.response.readings), self.response.light, self.response.view
        )
        at_white = self._effects(self.reference, *white)
        through = self.response.balance.through_white(samples.value)
        angle_white, seat_white = (
            np.einsum("nij,kj->kni", through, self._camera_share(each)[:, 0]) for each in at_white
        )
        turned = np.concatenate([samples.value * angle + angle_white, missed])
        moved = np.concatenate([samples.value * seat, seat_white])
        return np.sqrt((turned**2).sum(axis=0)), np.sqrt((moved**2).sum(axis=0))

    def _effects(
        self, material: Material, arms_rad: Array, light: Array, view: Array
    ) -> tuple[Array, Array]:
        stated = self.rig.uncertainty
        seat = seat_effects(
            material, light, view, tilt_rad=np.radians(stated.tilt_deg), height_mm=stated.height_mm,
            distance_mm=_MM_PER_M * self.rig.lamps.distance_m,
        )  # fmt: skip
        return axis_effects(material, arms_rad, float(np.radians(stated.angle_deg))), seat

    def _camera_share(self, effects: Array) -> Array:
        """Return relative errors of the reference in camera channels, from those in the space."""
        known = self.reference.evaluate(self.response.light, self.response.view)
        matrix = self.response.camera_from_space.T
        return np.asarray((effects * known) @ matrix / (known @ matrix))


def _arms(bracket: Sequence[Reading]) -> Array:
    return np.asarray(np.mean([reading.arms_rad for reading in bracket], axis=0))
