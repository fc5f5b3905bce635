"""Pairs of light and view directions that a scene asks for, in the frame of the sample."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from planner.scene.lights import Light
    from planner.scene.quantities import Array
    from planner.scene.scene import Scene
    from planner.scene.surfaces import Surface
    from planner.scene.viewers import Viewer

LOG2_SAMPLES = 18
_GRAZING = 1e-9
"""Cosine below which a direction counts as behind the surface: what is edge-on is rounding."""


@dataclass(frozen=True)
class LocalPairs:
    """Samples of what a scene asks for.

    Attributes
    ----------
    light, view
        Unit vectors away from the sample, shape (n, 3); +z its normal, +x its marked edge.
    weight
        What reaches the eye, were the material a perfect diffuser, shape (n,); adds up to one.
    """

    light: Array
    view: Array
    weight: Array

    @classmethod
    def weighed(cls, light: Array, view: Array, weight: Array) -> LocalPairs:
        """Keep the pairs that count, and scale their weights to add up to one.

        Raises
        ------
        BadInputError
            When none does.
        """
        counts = weight > 0
        if not counts.any():
            raise BadInputError(_why_nothing(light, view))
        # by the largest first: the sum of huge ones is not finite
        weight = weight[counts] / weight.max()
        return cls(light[counts], view[counts], weight / weight.sum())

    def turned(self, seed: int = 0) -> LocalPairs:
        """Turn each pair about the normal by any angle: to isotropic materials it is the same."""
        angle = np.random.default_rng(seed).uniform(0.0, 2 * np.pi, len(self.weight))
        cos, sin = np.cos(angle), np.sin(angle)

        def turn(vector: Array) -> Array:
            x, y, z = vector.T
            return np.stack([cos * x - sin * y, sin * x + cos * y, z], axis=-1)

        return LocalPairs(turn(self.light), turn(self.view), self.weight)


def sample_pairs(scene: Scene, seed: int = 0, log2_samples: int = LOG2_SAMPLES) -> LocalPairs:
    """Sample the pairs of directions that a scene asks for.

    Each sample has a surface, a light and a viewer, all combinations equally often, and a point,
    a normal and directions from them, by a scrambled Sobol sequence (Owen 1998). Its weight is the
    product of the three weights, the light's strength, the cosines of incidence and of view, and,
    within a viewer, the inverse square of the distance: how large the point looks.

    Parameters
    ----------
    scene
        What is there.
    seed
        Of the scrambling.
    log2_samples
        Logarithm to base 2 of how many samples to take.

    Raises
    ------
    BadInputError
        When no light reaches any surface that a viewer sees.
    """
    from scipy.stats import qmc

    sizes = (len(scene.surface), len(scene.light), len(scene.viewer))
    random = qmc.Sobol(11, rng=np.random.default_rng(seed)).random_base2(log2_samples)
    combination = (random[:, 0] * np.prod(sizes)).astype(np.int64)
    surface, light, viewer = np.unravel_index(combination, sizes)
    frame, point, weight = _surfaces(scene.surface, surface, random[:, 1:6])
    to_light, strength = _lights(scene.light, light, random[:, 6:8], point)
    to_view, size = _viewers(scene.viewer, viewer, random[:, 8:11], point)
    local_light = np.einsum("nij,nj->ni", frame, to_light)
    local_view = np.einsum("nij,nj->ni", frame, to_view)
    weight = weight * strength * size * _above(local_light) * _above(local_view)
    return LocalPairs.weighed(local_light, local_view, weight)


def _surfaces(
    surfaces: Sequence[Surface], which: NDArray[np.int64], random: Array
) -> tuple[Array, Array, Array]:
    """Return frame, point and weight of each sample's piece of surface."""
    count = len(which)
    frame, point, weight = np.empty((count, 3, 3)), np.empty((count, 3)), np.empty(count)
    scale = max(each.weight for each in surfaces)
    for index, rows in _groups(which):
        frame[rows], point[rows] = surfaces[index].elements(random[rows])
        weight[rows] = surfaces[index].weight / scale
    return frame, point, weight


def _lights(
    lights: Sequence[Light], which: NDArray[np.int64], random: Array, point: Array
) -> tuple[Array, Array]:
    """Return direction and weighted strength of each sample's light."""
    direction, strength = np.empty_like(point), np.empty(len(which))
    scale = max(each.weight for each in lights)
    for index, rows in _groups(which):
        direction[rows], strength[rows] = lights[index].arriving(random[rows], point[rows])
        strength[rows] *= lights[index].weight / scale
    return direction, strength


def _viewers(
    viewers: Sequence[Viewer], which: NDArray[np.int64], random: Array, point: Array
) -> tuple[Array, Array]:
    """Return direction and weighted apparent size of each sample's eye."""
    direction, size = np.empty_like(point), np.empty(len(which))
    scale = max(each.weight for each in viewers)
    for index, rows in _groups(which):
        direction[rows], distance = viewers[index].seen(random[rows], point[rows])
        looks = (distance.min() / distance) ** 2
        # a viewer's weight is what it counts altogether, wherever it stands
        size[rows] = looks / looks.mean() * (viewers[index].weight / scale)
    return direction, size


def _groups(which: NDArray[np.int64]) -> Iterator[tuple[int, NDArray[np.int64]]]:
    """Yield each number that occurs, and the rows that have it."""
    order = np.argsort(which, kind="stable")
    numbers, starts = np.unique(which[order], return_index=True)
    yield from zip(numbers.tolist(), np.split(order, starts[1:]), strict=True)


def _above(direction: Array) -> Array:
    """Return the cosine to the normal, 0 behind the surface."""
    cosine = direction[:, 2]
    return np.where(cosine > _GRAZING, cosine, 0.0)


def _why_nothing(light: Array, view: Array) -> str:
    lit, seen = (float(np.mean(_above(each) > 0)) for each in (light, view))
    return (
        "the scene asks for no pair of directions: no light shines on what a viewer sees (lights "
        f"stand before a surface in {lit:.0%} of the samples, viewers in {seen:.0%}); turn the "
        "surfaces, raise the lights or move the viewers"
    )
