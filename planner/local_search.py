"""Local search for a short route, compiled; in NumPy where nothing was compiled."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from planner.exchange import two_opt

try:
    from planner import _route
except ImportError:
    _route = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from planner.metric import TimeMetric
    from planner.places import Places

    Indices = NDArray[np.int64]

_UNIT_S = 1e-9
_LARGEST = 2.0**61
_BLOCKED = 100.0
"""How many times the longest move one that cannot be made counts as."""


def is_available() -> bool:
    """Tell whether the kernel was compiled when gonio was installed."""
    return _route is not None


def improve(
    metric: TimeMetric, arms: tuple[Places, Places], order: Indices, work: int, seed: int
) -> tuple[TimeMetric, Indices]:
    """Shorten a route, with the places that its shots are at.

    Compiled: parts are reversed, moved and exchanged and other places taken until nothing saves
    time; then so often a random part is disturbed and what follows kept if it is no longer
    (iterated local search; Lourenco, Martin and Stuetzle 2003). In NumPy: parts are reversed, as
    if moves had no direction and none were slow.

    Parameters
    ----------
    metric
        Between all places; slow moves are longer than the tables say.
    arms
        The places of view and light.
    order
        The route, shot numbers of shape (n,).
    work
        How often the metric may be looked at, about: a count, so that a route repeats to the bit.
    seed
        Of the disturbances.

    Returns
    -------
    TimeMetric, ndarray
        With the shots at their new places, and the new route; never longer than before.
    """
    found, route = (_compiled if is_available() else _in_numpy)(metric, arms, order, work, seed)
    route = min(route, route[::-1], key=found.total)
    # whole nanoseconds may call shorter what is longer by round-off
    return (found, route) if found.total(route) < metric.total(order) else (metric, order)


def _compiled(
    metric: TimeMetric, arms: tuple[Places, Places], order: Indices, work: int, seed: int
) -> tuple[TimeMetric, Indices]:
    unit_s = _unit_s(metric)
    near = metric.least(*arms)
    tables = _tables(metric, unit_s)
    if len(metric.slow_keys):
        slow = np.minimum(metric.slow_s, _BLOCKED * _longest_s(metric)) / unit_s
        tables.override(*metric.slow_moves, slow.astype(np.int64))
    views, lights = ([each.tolist() for each in places.choices] for places in arms)
    route, poses = _route.search(
        tables, _tables(near, unit_s), views, lights, near.poses, metric.poses, order, work, seed
    )
    return replace(metric, poses=poses), route


def _in_numpy(
    metric: TimeMetric, _arms: tuple[Places, Places], order: Indices, _work: int, _seed: int
) -> tuple[TimeMetric, Indices]:
    return metric, two_opt(metric.either_way, order)


def tree_bound_s(metric: TimeMetric, order: Indices) -> float:
    """Return what no route can beat, by trees with prices (Held and Karp 1971); compiled only.

    Parameters
    ----------
    metric
        Symmetric.
    order
        A good route.
    """
    unit_s = _unit_s(metric)
    return float(_route.bound(_tables(metric, unit_s), metric.poses, order) * unit_s)


def _longest_s(metric: TimeMetric) -> float:
    return max(float((arm.go_s + arm.run_s).max()) for arm in (metric.view, metric.light)) * 2


def _unit_s(metric: TimeMetric) -> float:
    """Return how long a one of the whole numbers is: more where long sums ask for it."""
    return max(_UNIT_S, _longest_s(metric) * _BLOCKED * (len(metric) + 1) / _LARGEST)


def _tables(metric: TimeMetric, unit_s: float) -> Any:
    # rounded down, so that a bound stays one
    return _route.Metric(
        *(
            np.floor(table / unit_s).astype(np.int64, order="C")
            for arm in (metric.view, metric.light)
            for table in (arm.go_s, arm.run_s)
        )
    )
