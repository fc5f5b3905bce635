"""The white reference: how much each of the camera's channels answers to a known BRDF."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import normalize
from gonio.errors import BadInputError
from gonio.reduce.balance import balance
from gonio.reduce.merge import merge

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.protocols import Material
    from gonio.reduce.balance import Balance
    from gonio.reduce.color import Coloring
    from gonio.reduce.merge import Rate
    from gonio.reduce.reading import Reading


@dataclass(frozen=True)
class Response:
    """How a rate becomes a BRDF.

    Attributes
    ----------
    balance
        From rates over the white's to the space of the results.
    rate, readings
        Of the white reference.
    light, view
        Where it was seen, unit vectors, shape (3,).
    """

    balance: Balance
    rate: Rate
    readings: tuple[Reading, ...]
    light: NDArray[np.float64]
    view: NDArray[np.float64]

    @cached_property
    def rate_per_brdf(self) -> NDArray[np.float64]:
        """Of a white-balanced camera channel, in the unit of `Rate` per 1/sr, shape (3,)."""
        return np.asarray(self.rate.value / self.balance.channels)

    @cached_property
    def camera_from_space(self) -> NDArray[np.float64]:
        """The space of the results to white-balanced camera RGB, shape (3, 3)."""
        return np.asarray(np.linalg.inv(self.balance.matrix / self.balance.channels))

    def brdf(self, rate: Rate) -> NDArray[np.float64]:
        """Return the BRDF in the space of the results, in 1/sr, shape (3,).

        Clipped channels are cut to the lowest of their bounds, so that a white highlight, which
        they reach at different levels, stays white.
        """
        camera = rate.value / self.rate_per_brdf
        lowest = np.min(camera, where=rate.clipped, initial=np.inf)
        camera = np.where(rate.clipped, lowest, camera)
        return self.in_space(camera)

    def in_space(self, camera: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return white-balanced camera channels, or a signed error of them, in the space."""
        return np.asarray(camera @ np.linalg.inv(self.camera_from_space).T)

    def sigma_in_space(self, variance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return sigma in the space for variances of camera channels that err independently."""
        return np.asarray(np.sqrt(variance @ np.linalg.inv(self.camera_from_space).T ** 2))


def respond(
    readings: Sequence[Reading], gain: float, reference: Material, coloring: Coloring
) -> Response:
    """Compare the white frames' rate with the reference's BRDF at their true directions.

    Raises
    ------
    gonio.errors.BadInputError
        When they are dark, or saturated in every exposure.
    """
    rate = merge(readings, gain)
    if rate.clipped.any() or not (rate.value > 0).all():
        state = "saturated in every exposure" if rate.clipped.any() else "dark"
        raise BadInputError(
            f"the white reference is {state}; check the lamps, the reference and exposures_s in "
            "rig.toml, and capture again"
        )
    light, view = (
        normalize(np.mean([getattr(reading, side) for reading in readings], axis=0))
        for side in ("light", "view")
    )
    known = reference.evaluate(light, view)
    return Response(balance(coloring, rate.value, known), rate, tuple(readings), light, view)
