"""What a material sends where, for each of the 81 lights: over the hemisphere, and in its plane."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.directions import from_spherical, paper_angles_deg
from gonio.report.expected import FLOOR

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from gonio.protocols import Estimate, Material

    Array = NDArray[np.float64]

RING_DEG, AZIMUTH_DEG = 5.0, 10.0
RINGS, AZIMUTHS = 16, 36
"""Of a lobe: views from the pole to 75 deg, and around, counted from the light's own azimuth."""

STEP_DEG, STEPS = 2.5, 61
"""Of a slice: views from -75 to 75 deg, positive away from the light."""


class Lobes(NamedTuple):
    """The mean of the channels over the hemisphere of views.

    Attributes
    ----------
    value
        1/sr, shape (81, RINGS, AZIMUTHS).
    relative
        Standard uncertainty over value, likewise.
    """

    value: Array
    relative: Array


class Slices(NamedTuple):
    """The plane of incidence.

    Attributes
    ----------
    value
        1/sr, shape (81, STEPS, 3).
    lo, hi
        5 and 95 % quantiles, mean of the channels, shape (81, STEPS).
    truth
        Mean of the channels, likewise; None where it is not known.
    """

    value: Array
    lo: Array
    hi: Array
    truth: Array | None


def lobes_of(estimate: Estimate, white: float) -> Lobes:
    """Return the lobes of an estimate with that white in 1/sr."""
    theta, phi = (np.radians(angle) for angle in paper_angles_deg())
    ring, around = np.radians(RING_DEG * np.arange(RINGS)), AZIMUTH_DEG * np.arange(AZIMUTHS)
    view = from_spherical(ring[None, :, None], phi[:, None, None] + np.radians(around))
    light = np.broadcast_to(from_spherical(theta, phi)[:, None, None], view.shape)
    value, sigma = (_flat(ask, light, view) for ask in (estimate.evaluate, estimate.sigma))
    relative = (sigma / (value + FLOOR * white)).mean(axis=-1)
    return Lobes(value.mean(axis=-1), relative)


def slices_of(estimate: Estimate, truth: Material | None) -> Slices:
    """Return the slices of an estimate, and of the truth where it is known."""
    theta, phi = (np.radians(angle) for angle in paper_angles_deg())
    angle = np.radians(STEP_DEG * (np.arange(STEPS) - STEPS // 2))
    view = from_spherical(angle[None], phi[:, None] + np.pi)
    light = np.broadcast_to(from_spherical(theta, phi)[:, None], view.shape)
    # as if the channels erred together: the band of their mean is then the mean of their bands
    low, high = (band.mean(axis=-1) for band in estimate.quantiles(light, view))
    true = None if truth is None else _flat(truth.evaluate, light, view).mean(axis=-1)
    return Slices(estimate.evaluate(light, view), low, high, true)


def _flat(ask: Callable[[Array, Array], Array], light: Array, view: Array) -> Array:
    return ask(light.reshape(-1, 3), view.reshape(-1, 3)).reshape(view.shape)
