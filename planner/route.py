"""The order of shots in which the arms spend the least time moving."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from planner.construct import first_routes
from planner.few import FEW, shortest
from planner.local_search import improve, is_available
from planner.metric import TimeMetric
from planner.places import Places
from planner.route_bound import bound_s
from planner.turns import with_best_places

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from gonio.rig import Rig
    from gonio.timing import Timing

    Array = NDArray[np.float64]
    Indices = NDArray[np.int64]
    Arms = tuple[Places, Places]
    Ways = Callable[[Array, Array], Array]

WORK = 300_000
_MOST_WORK = 200_000_000
"""Looks at the metric for each shot, and for all: counts, so that a route repeats to the bit."""

_ROUNDS = 20
"""How often true times of moves are asked for, and the route searched again."""

_SLOWER_S = 1e-6
"""By how much a true time must exceed the axes' own to count as another."""


@dataclass(frozen=True)
class Route:
    """A route and what is known of it.

    Attributes
    ----------
    order
        Shot numbers in the order to take them, shape (n,).
    phi_deg
        Azimuths of view and light along the route, in [0, 360), shape (n, 2): those of the shots
        but at the pole, where any will do.
    turns
        Full turns of the phi axes beyond these, shape (n, 2).
    moving_s
        Seconds of all moves, the true times of blocked ones included.
    method
        How it was found.
    """

    order: NDArray[np.int64]
    phi_deg: Array
    turns: NDArray[np.int64]
    moving_s: float
    method: str
    _least: TimeMetric

    @cached_property
    def bound_s(self) -> float:
        """Seconds that no route can beat."""
        # a bound that is met may be above by round-off
        return min(self.moving_s, bound_s(self._least, self.order))


def plan_route(
    angles_deg: Array,
    rig: Rig,
    timing: Timing | None = None,
    way_s: Ways | None = None,
    seed: int = 0,
    work: int = WORK,
) -> Route:
    """Order shots for the least time of moving.

    Three routes are built, each is improved by local search, and the quickest is searched on. Of
    few shots the shortest route of all is found.

    Parameters
    ----------
    angles_deg
        Theta and phi of view and light of each shot, shape (n, 4), in the order of
        `gonio.rig.AXES`; phi in [0, 360), to which the route may add turns of the axis.
    rig
        Whose axes' travel and run-ups count.
    timing
        How its axes act; without it, just as the rig file says.
    way_s
        Tells the true seconds of moves that something may block: of those from axis angles
        (m, 4) to axis angles (m, 4), shape (m,). Asked only for the moves of good routes.
    seed
        Of the search.
    work
        How often the search may look at the metric for each shot.

    Raises
    ------
    BadInputError
        When no order was found in which there is a way from each shot to the next.
    """
    view = Places.of(angles_deg[:, :2], rig.axis.view_phi)
    light = Places.of(angles_deg[:, 2:], rig.axis.light_phi)
    arms = (view, light)
    metric = TimeMetric.between_places(view, light, rig, timing)
    metric, order, method = _started(metric, arms)
    looks = min(work * len(order), _MOST_WORK)
    metric, order = _searched(metric, order, arms, looks, seed)
    if way_s is not None:
        metric, order = _around(metric, order, arms, way_s, looks // _ROUNDS, seed)
    places = list(zip(arms, metric.poses[order].T, strict=True))
    moving_s = metric.total(order)
    if not np.isfinite(moving_s):
        raise BadInputError(
            f"no order of the {len(order)} shots was found in which the arms have a free way from "
            "each to the next; leave out directions, or correct the rig file if it is wrong"
        )
    return Route(
        order=order,
        phi_deg=np.stack([arm.phi_deg[at] for arm, at in places], axis=1),
        turns=np.stack([arm.turn[at] for arm, at in places], axis=1),
        moving_s=moving_s,
        method=_method(method, len(order)),
        _least=metric.least(*arms),
    )


def _method(start: str, shots: int) -> str:
    if shots <= FEW:
        return "the shortest of all"
    return f"{start}, local search" if is_available() else f"{start}, 2-opt in NumPy"


def _started(metric: TimeMetric, arms: Arms) -> tuple[TimeMetric, Indices, str]:
    """Return the quickest of some first routes, each improved, and its name."""
    found = [
        (*improve(metric, arms, order, work=0, seed=0), name)
        for name, order in first_routes(metric).items()
    ]
    return min(found, key=lambda each: each[0].total(each[1]))


def _searched(
    metric: TimeMetric, order: Indices, arms: Arms, work: int, seed: int
) -> tuple[TimeMetric, Indices]:
    if len(order) <= FEW:
        return shortest(metric, arms)
    metric = with_best_places(metric, order, arms)
    metric, order = improve(metric, arms, order, work, seed)
    return with_best_places(metric, order, arms), order


def _around(
    metric: TimeMetric, order: Indices, arms: Arms, way_s: Ways, looks: int, seed: int
) -> tuple[TimeMetric, Indices]:
    """Ask for the true times of a route's moves, and search again with what is slow, in turns."""
    asked = np.empty(0, np.int64)
    best, best_order = metric, order
    for _ in range(_ROUNDS):
        keys = metric.key(metric.poses[order[:-1]], metric.poses[order[1:]])
        new = np.flatnonzero(~np.isin(keys, asked))
        asked = np.append(asked, keys[new])
        metric = _told(metric, order, new, arms, way_s)
        best = replace(best, slow_keys=metric.slow_keys, slow_s=metric.slow_s)
        if metric.total(order) < best.total(best_order):
            best, best_order = metric, order
        if not len(new):
            break
        metric, order = _searched(best, best_order, arms, looks, seed)
    return best, best_order


def _told(
    metric: TimeMetric, order: Indices, steps: Indices, arms: Arms, way_s: Ways
) -> TimeMetric:
    """Return the metric with the true times of some steps of a route."""
    if not len(steps):
        return metric
    starts, goals = metric.poses[order[steps]], metric.poses[order[steps + 1]]
    angles = (
        np.hstack([places.angles_deg[at] for places, at in zip(arms, ends.T, strict=True)])
        for ends in (starts, goals)
    )
    true_s = np.asarray(way_s(*angles), np.float64)
    slow = true_s > metric.times(starts, goals) + _SLOWER_S
    return metric.with_slow(starts[slow], goals[slow], true_s[slow])
