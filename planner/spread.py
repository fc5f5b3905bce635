"""Criteria that know nothing of materials: directions and pairs far apart, or drawn at random."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from planner.criteria import Choice
from planner.pairing import may_join, product_of
from planner.subset import angles_between, farthest_from, farthest_points, least_energy

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from planner.budget import Terms
    from planner.field import Field
    from planner.pairing import Chosen
    from planner.subset import MayJoin

    Array = NDArray[np.float64]

_CLOSE = 1e-2


class _Blind:
    """What knows nothing of materials cannot say what a pair is worth."""

    def within(self, field: Field, seconds: float, terms: Terms) -> Choice:
        """Refuse: only a prior tells what a second is worth."""
        raise BadInputError(
            "--hours weighs what a pair tells against its time, which only a prior knows; use "
            "criterion i-optimal or d-optimal"
        )


class RandomChoice(_Blind):
    """Directions or pairs drawn at random, all alike: what any criterion has to beat.

    Parameters
    ----------
    seed
        Another gives another choice.
    """

    def __init__(self, seed: int) -> None:
        self._seed = seed

    def product(self, field: Field, lights: int, views: int) -> Choice:
        """Draw lights and views independently."""
        rng = np.random.default_rng(self._seed)
        chosen: tuple[list[int], list[int]] = ([], [])
        for axis, count in enumerate((lights, views)):
            for _ in range(count):
                may = may_join(field.allowed, chosen, (lights, views), axis)
                chosen[axis].append(int(rng.choice(np.flatnonzero(may))))
        return Choice(product_of(field.allowed, *chosen))

    def pairs(self, field: Field, count: int) -> Choice:
        """Draw allowed pairs."""
        rng = np.random.default_rng(self._seed)
        return Choice(_some(field, rng.choice(np.flatnonzero(field.allowed), count, replace=False)))


class FarthestPoint(_Blind):
    """Each direction, or pair, as far as can be from those before it.

    Lights start at the first candidate. The views start at the candidate farthest from the chosen
    lights: were the two sets equal, every pair of different directions would be measured twice,
    since a BRDF is reciprocal.
    """

    def product(self, field: Field, lights: int, views: int) -> Choice:
        """Choose by great-circle distance (see `planner.subset.farthest_points`)."""
        light, view = field.lights.directions, field.views.directions
        of_lights, of_views = _joining(field, lights, views)
        chosen = farthest_points(light, lights, int(np.argmax(of_lights([]))), of_lights)
        may = of_views(chosen)
        start = farthest_from(view, light[chosen], may([]))
        return Choice(product_of(field.allowed, chosen, farthest_points(view, views, start, may)))

    def pairs(self, field: Field, count: int) -> Choice:
        """Choose by the distance of pairs (see `pair_distances`)."""
        return Choice(_spread_pairs(field, count, np.minimum, np.inf))


class LeastEnergy(_Blind):
    """Directions, or pairs, that repel each other: least Riesz energy, grown and exchanged.

    The energy is the sum of distance^-s over all two, with s = 3 for directions and 5 for pairs,
    above the dimension of either, so that they spread evenly and do not crowd at the rim (Hardin
    and Saff 2004). The lights repel the views, since a BRDF is reciprocal.
    """

    def product(self, field: Field, lights: int, views: int) -> Choice:
        """Choose lights, then views."""
        light, view = field.lights.directions, field.views.directions
        of_lights, of_views = _joining(field, lights, views)
        chosen = least_energy(light, lights, may=of_lights)
        others = least_energy(view, views, light[chosen], of_views(chosen))
        return Choice(product_of(field.allowed, chosen, others))

    def pairs(self, field: Field, count: int) -> Choice:
        """Choose pairs one after the other, each where the energy is least."""
        return Choice(_spread_pairs(field, count, _repelled, 0.0))


def pair_distances(field: Field, pair: tuple[int, int]) -> Array:
    """Return how far all pairs are from one, in radians, shape (L, V).

    The root of the squared angles between lights and between views, or with light and view of one
    of the two exchanged, whichever is less: a BRDF is reciprocal.
    """
    lights, views = field.lights.directions, field.views.directions
    light, view = lights[pair[0]][None], views[pair[1]][None]

    def apart(a: Array, b: Array) -> Array:
        squares = (angles_between(each, one)[:, 0] ** 2 for each, one in ((lights, a), (views, b)))
        return np.add.outer(*squares)

    return np.asarray(np.sqrt(np.minimum(apart(light, view), apart(view, light))))


def _repelled(worth: Array, distance: Array) -> Array:
    return worth - np.maximum(distance, _CLOSE) ** -5.0


def _spread_pairs(
    field: Field, count: int, join: Callable[[Array, Array], Array], start: float
) -> NDArray[np.bool_]:
    """Take pairs in turn where what `join` makes of the distances from those before is largest."""
    worth = np.full(field.allowed.shape, start)
    measured = np.zeros_like(field.allowed)
    for _ in range(count):
        free = np.where(field.allowed & ~measured, worth, -np.inf)
        pair = np.unravel_index(int(np.argmax(free)), free.shape)
        measured[pair] = True
        worth = join(worth, pair_distances(field, (int(pair[0]), int(pair[1]))))
    return measured


def _joining(field: Field, lights: int, views: int) -> tuple[MayJoin, Callable[[Chosen], MayJoin]]:
    """Return which lights may join those chosen, and, for some lights, which views may."""
    wanted = lights, views

    def of_lights(chosen: Chosen) -> NDArray[np.bool_]:
        return may_join(field.allowed, (chosen, ()), wanted, axis=0)

    def of_views(chosen_lights: Chosen) -> MayJoin:
        return lambda chosen: may_join(field.allowed, (chosen_lights, chosen), wanted, axis=1)

    return of_lights, of_views


def _some(field: Field, pairs: NDArray[np.int64]) -> NDArray[np.bool_]:
    chosen = np.zeros_like(field.allowed)
    chosen.flat[pairs] = True
    return chosen
