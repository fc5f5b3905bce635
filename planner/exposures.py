"""Which exposures each shot needs, from how bright it is expected to be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.directions import from_degrees
from gonio.materials import reference_material

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.plan import Shot
    from gonio.protocols import Prior
    from gonio.rig import Rig
    from gonio.timing import Timing

    Array = NDArray[np.float64]

BRIGHTEST: Final = 0.7
"""Share of the camera's range that a shot may fill: one channel may be brighter than expected."""

FAINTEST: Final = 0.002
"""Share of the range that is still well exposed: a patch of a hundred pixels tells it to 2 %."""

_Z95 = 1.6448536269514722


def with_predicted_exposures(
    shots: Sequence[Shot], prior: Prior, rig: Rig, timing: Timing
) -> tuple[Shot, ...]:
    """Return shots that take only the exposures that a material of the prior may need there.

    Parameters
    ----------
    shots
        Under all lamps at full current.
    prior
        What is believed of the material, before it is measured or after.
    rig, timing
        Exposures to choose from, and the camera's sensitivity.
    """
    angles = np.array(
        [(s.light_theta_deg, s.light_phi_deg, s.view_theta_deg, s.view_phi_deg) for s in shots]
    )
    light, view = from_degrees(*angles[:, :2].T), from_degrees(*angles[:, 2:].T)
    brackets = Exposer.of(rig, timing).choose(*prior.expected(light, view), light[:, 2])
    return tuple(
        shot.model_copy(update={"exposures_s": bracket})
        for shot, bracket in zip(shots, brackets, strict=True)
    )


@dataclass(frozen=True)
class Exposer:
    """Chooses of a rig's exposures the fewest that see a shot, however bright it may turn out.

    Attributes
    ----------
    exposures_s
        To choose from, rising.
    full_s
        Exposure at which a surface of a BRDF of 1/sr, lit along its normal, fills the range.
    white_s
        The same for the white reference at 0:45.
    """

    exposures_s: tuple[float, ...]
    full_s: float
    white_s: float

    @classmethod
    def of(cls, rig: Rig, timing: Timing) -> Exposer:
        """Make the one of a rig whose camera is as sensitive as its timing says."""
        light, view = from_degrees([0.0, 45.0], [0.0, 0.0])
        white = float(reference_material(rig).evaluate(light, view).max())
        exposures_s = tuple(sorted(rig.camera.exposures_s))
        return cls(exposures_s, timing.white_level_s * white, timing.white_level_s)

    def choose(self, mean: Array, sd: Array, cos_light: Array) -> list[tuple[float, ...]]:
        """Return the exposures of each shot, rising.

        Over the 5 to 95 % interval of its brightness at least one leaves the camera's range
        unfilled and is well exposed, as far as the rig's exposures allow. One of all shots suits
        the white reference, without which nothing has a scale.

        Parameters
        ----------
        mean, sd
            Of ln(BRDF in 1/sr) at each shot, shape (n,).
        cos_light
            Cosine of the light's polar angle, shape (n,).
        """
        low, high = mean - _Z95 * sd, mean + _Z95 * sd
        # at grazing light the exposures that fill the range have no bound
        fill_s = self.full_s / np.maximum(cos_light, 1e-6)
        brackets = [
            self._bracket(float(short), float(long))
            for short, long in zip(
                fill_s * np.exp(np.clip(-high, -700.0, 700.0)),
                fill_s * np.exp(np.clip(-low, -700.0, 700.0)),
                strict=True,
            )
        ]
        return self._with_white(brackets)

    def _bracket(self, shortest_fill_s: float, longest_fill_s: float) -> tuple[float, ...]:
        """Cover what may fill the range in the one time to the other, the brightest first."""
        chosen: list[float] = []
        reached_s = shortest_fill_s
        while not chosen or (chosen[-1] < self.exposures_s[-1] and reached_s < longest_fill_s):
            unfilled = [e for e in self.exposures_s if e <= BRIGHTEST * reached_s]
            longer = [e for e in self.exposures_s if not chosen or e > chosen[-1]]
            # the longest that the brightest of the rest leaves unfilled; across a gap, the next
            best = unfilled[-1] if unfilled and unfilled[-1] in longer else longer[0]
            chosen.append(best)
            reached_s = best / FAINTEST
        return tuple(chosen)

    def _with_white(self, brackets: Sequence[tuple[float, ...]]) -> list[tuple[float, ...]]:
        low_s, high_s = FAINTEST * self.white_s, BRIGHTEST * self.white_s
        fit = [e for e in self.exposures_s if low_s <= e <= high_s]
        if not fit or any(exposure in fit for bracket in brackets for exposure in bracket):
            return list(brackets)
        first, *rest = brackets
        return [tuple(sorted((*first, fit[-1]))), *rest]
