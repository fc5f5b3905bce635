"""The order of shots in which the arms spend the least time moving."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from planner.metric import TimeMetric

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import Rig

_WORK = 100_000_000
"""Evaluations of the metric that one local search may make; a count, so that it repeats."""

_GAIN_S = 1e-9
"""What an exchange must save, so that round-off does not exchange for ever."""


class Route(NamedTuple):
    """Shot numbers in the order to take them, shape (n,), and how that was found."""

    order: NDArray[np.int64]
    method: str


def plan_route(angles_deg: NDArray[np.float64], rig: Rig) -> Route:
    """Order shots for the least time of moving.

    Three routes are built, each is improved by 2-opt exchanges, and the quickest is taken.

    Parameters
    ----------
    angles_deg
        The axes' angles at each shot, shape (n, 4), in the order of `gonio.rig.AXES`.
    rig
        Whose axes' speeds and accelerations count.
    """
    metric = TimeMetric.of(angles_deg, rig)
    starts = {
        "nearest neighbour": nearest_neighbour(metric),
        "snake of views": snake(metric.light, metric.light_s, metric.view, metric.view_s),
        "snake of lights": snake(metric.view, metric.view_s, metric.light, metric.light_s),
    }
    routes = [Route(two_opt(metric, order), f"{name}, 2-opt") for name, order in starts.items()]
    return min(routes, key=lambda route: metric.total(route.order))


def nearest_neighbour(metric: TimeMetric) -> NDArray[np.int64]:
    """Go from the first shot always to the nearest that is left; ties to the lowest number."""
    order = np.zeros(len(metric), dtype=np.int64)
    left = np.arange(1, len(metric))
    for position in range(1, len(metric)):
        nearest = int(np.argmin(metric.between(order[position - 1], left)))
        order[position] = left[nearest]
        left = np.delete(left, nearest)
    return order


def two_opt(metric: TimeMetric, order: NDArray[np.int64], work: int = _WORK) -> NDArray[np.int64]:
    """Reverse parts of a route as long as that saves time (Croes 1958).

    The route is closed through a shot that is nowhere, so its ends count as any other place.

    Parameters
    ----------
    metric
        Symmetric seconds between shots.
    order
        The route, shot numbers of shape (n,).
    work
        Bound on the evaluations of the metric.
    """
    nowhere = len(order)
    metric, tour = metric.with_nowhere(), np.append(order, nowhere)
    step_s = metric.between(tour, np.roll(tour, -1))
    place = rested = 0
    while rested < len(tour) and work > 0:
        other, gain_s = _best_exchange(metric, tour, step_s, place)
        work -= 2 * len(tour)
        if gain_s > _GAIN_S:
            low, high = sorted((place, other))
            tour[low + 1 : high + 1] = tour[low + 1 : high + 1][::-1].copy()
            step_s = metric.between(tour, np.roll(tour, -1))
            rested = 0
        else:
            place, rested = (place + 1) % len(tour), rested + 1
    start = int(np.argmax(tour == nowhere)) + 1
    return np.roll(tour, -start)[:-1]


def _best_exchange(
    metric: TimeMetric, tour: NDArray[np.int64], step_s: NDArray[np.float64], place: int
) -> tuple[int, float]:
    """Return the step to exchange with the one from `place`, and the seconds that this saves."""
    after = np.roll(tour, -1)
    exchanged = metric.between(tour[place], tour) + metric.between(after[place], after)
    gain_s = step_s[place] + step_s - exchanged
    gain_s[place] = 0.0
    best = int(np.argmax(gain_s))
    return best, float(gain_s[best])


def snake(
    slow: NDArray[np.int64],
    slow_s: NDArray[np.float64],
    fast: NDArray[np.int64],
    fast_s: NDArray[np.float64],
) -> NDArray[np.int64]:
    """Let one arm stand while the other goes through its directions, to and fro.

    `slow` and `fast` are the direction that each shot has of either arm, shape (n,); `slow_s` and
    `fast_s` the seconds between these directions.
    """
    slow_rank = _ranks(slow_s)[slow]
    fast_rank = _ranks(fast_s)[fast]
    return np.lexsort((np.where(slow_rank % 2, -fast_rank, fast_rank), slow_rank))


def _ranks(times_s: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the place of each of an arm's directions on a short path through all of them."""
    metric = TimeMetric.of_one_arm(times_s)
    return np.argsort(two_opt(metric, nearest_neighbour(metric)))
