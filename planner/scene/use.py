"""How a material will be used, as far as planning is concerned."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from planner.scene.demand import LEFT_OUT_SHARE, Demand

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from planner.candidates import Candidates
    from planner.field import Field
    from planner.scene.pairs import LocalPairs
    from planner.scene.quantities import Array

    Omission = Callable[[Field], NDArray[np.bool_]]

NOT_ASKED = f"the scene does not ask for ({LEFT_OUT_SHARE:.0%} of its demand)"
SAME_AZIMUTH = "equal to others at another azimuth, as the material is isotropic"


@dataclass(frozen=True)
class Use:
    """What of a material counts.

    Attributes
    ----------
    pairs
        What a scene asks for; None: all pairs alike.
    isotropic
        Whether the material is said to depend on azimuths by their difference alone.
    """

    pairs: LocalPairs | None = None
    isotropic: bool = False
    _known: dict[bytes, Demand] = field(default_factory=dict, init=False, repr=False, compare=False)

    def demand(self, lights: Candidates, views: Candidates) -> Array:
        """Return how much each pair counts, shape (lights, views); adds up to one."""
        if self._seen is None:
            return np.full((len(lights), len(views)), 1 / (len(lights) * len(views)))
        return self._demand(self._seen, lights, views).weights

    def asked(self, lights: Candidates, views: Candidates) -> NDArray[np.bool_]:
        """Return which pairs tell of what is asked for, shape (lights, views)."""
        if self._seen is None:
            return np.ones((len(lights), len(views)), bool)
        return self._demand(self._seen, lights, views).asked()

    def omissions(self) -> Mapping[str, Omission]:
        """Return what may be left out of a field, by reason, in the order of the reasons."""
        found: dict[str, Omission] = {}
        if self.pairs is not None:
            found[NOT_ASKED] = lambda every: ~self.asked(every.lights, every.views)
        if self.isotropic:
            found[SAME_AZIMUTH] = _other_azimuths
        return found

    def _demand(self, seen: LocalPairs, lights: Candidates, views: Candidates) -> Demand:
        key = lights.directions.tobytes() + b"/" + views.directions.tobytes()
        if key not in self._known:
            self._known[key] = Demand.of(seen, lights, views)
        return self._known[key]

    @cached_property
    def _seen(self) -> LocalPairs | None:
        if self.pairs is None or not self.isotropic:
            return self.pairs
        return self.pairs.turned()


def _other_azimuths(every: Field) -> NDArray[np.bool_]:
    """Return the pairs whose light is not the first of its ring, shape (lights, views).

    The arm then need not turn the light about the normal at all. Of each ring it is the light with
    most pairs that the rig can take.
    """
    others = np.ones(every.allowed.shape, bool)
    rings = every.lights.theta_deg.round(6)
    reach = every.allowed.sum(axis=1)
    for ring in np.unique(rings):
        lights = np.flatnonzero(rings == ring)
        others[lights[np.argmax(reach[lights])]] = False
    return others
