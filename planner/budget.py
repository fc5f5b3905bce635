"""A time budget: the pairs that tell most per second, each for what it costs to reach and take."""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from gonio.protocols import Progress
    from planner.information import Unknown
    from planner.search import Measure

    Array = NDArray[np.float64]
    Indices = NDArray[np.int64]

_ROUNDS = 8
_NOWHERE = -1


class Moves(Protocol):
    """Seconds between shots, by their numbers (`planner.metric.TimeMetric`)."""

    def between(self, a: Indices | np.int64, b: Indices | np.int64) -> Array:
        """Return the seconds from shots `a` to shots `b`, broadcast."""


class Priced(NamedTuple):
    """What a set of pairs costs: the order that takes least time, and the seconds of the whole."""

    order: list[int]
    total_s: float


class Pricer(Protocol):
    """Orders pairs and says what capturing them takes, calibration and all."""

    def __call__(self, pairs: Sequence[int]) -> Priced:
        """Price pairs, numbers of the field."""


class Terms(NamedTuple):
    """What pairs cost.

    Attributes
    ----------
    moves
        Between all pairs.
    shot_s
        Seconds of each pair's shot without the move to it, shape (pairs,).
    price
        Of a whole set.
    """

    moves: Moves
    shot_s: Array
    price: Pricer


def pairs_within(
    kinds: Sequence[Unknown],
    allowed: NDArray[np.bool_],
    seconds: float,
    terms: Terms,
    measure: Measure,
    progress: Progress | None = None,
) -> Priced | None:
    """Choose pairs that tell as much as can be had in a time.

    Pair after pair is put into the route where it costs least time, always the one of the largest
    gain per second (the cost-benefit greedy of Khuller, Moss and Naor 1999). Then the whole is put
    in order anew, and the time that this saves buys more.

    Parameters
    ----------
    kinds
        Fresh.
    allowed
        Which pairs may be chosen, shape (pairs,).
    seconds
        What the whole may take.
    terms, measure
        What pairs cost, and what counts as gain.
    progress
        Called with the seconds used and those there are.

    Returns
    -------
    Priced or None
        None where not even one pair fits.
    """
    everything = np.flatnonzero(allowed).tolist()
    # the moves cost more, but are dear to order
    if terms.shot_s[allowed].sum() <= seconds:
        whole = terms.price(everything)
        if whole.total_s <= seconds:
            return whole
    alone = np.where(allowed, _gains(kinds, measure), -np.inf)
    best = terms.price([int(np.argmax(alone))])
    # so that a time that is no number is too short, too
    if not best.total_s <= seconds:
        return None
    for _ in range(_ROUNDS):
        for kind in kinds:
            kind.forget(np.array(best.order, np.int64))
        used = partial(_report, progress, seconds)
        more = _grown(kinds, allowed, best.order, seconds - best.total_s, terms, measure, used)
        priced = _fitting(best, more, seconds, terms.price)
        if priced is best:
            break
        best = priced
    return best


def _fitting(now: Priced, more: Sequence[int], seconds: float, price: Pricer) -> Priced:
    """Return the pairs of `now` with as many of `more`, first come first, as the time allows."""
    best, low, high = now, 0, len(more)
    while low < high:
        # all of them, first: most often the guess of the costs holds
        count = high if best is now and high == len(more) else (low + high + 1) // 2
        priced = price([*now.order, *more[:count]])
        if priced.total_s <= seconds:
            best, low = priced, count
        else:
            high = count - 1
    return best


def _grown(
    kinds: Sequence[Unknown],
    allowed: NDArray[np.bool_],
    order: Sequence[int],
    seconds: float,
    terms: Terms,
    measure: Measure,
    report: Callable[[float], None],
) -> list[int]:
    """Return pairs to add, in the order of their choice, until the time is used up."""
    free = allowed.copy()
    free[order] = False
    route = _Insertion(terms.moves, len(allowed), order)
    added: list[int] = []
    while True:
        cost = route.least_s + terms.shot_s
        # a move may cost nothing, and a rig's overhead too: then the gain alone decides
        worth = _gains(kinds, measure) / np.maximum(cost, 1e-9)
        worth = np.where(free & (cost <= seconds), worth, -np.inf)
        pair = int(np.argmax(worth))
        if not np.isfinite(worth[pair]):
            return added
        seconds -= float(cost[pair])
        report(seconds)
        route.insert(pair)
        free[pair] = False
        added.append(pair)
        for kind in kinds:
            kind.turn(pair, known=True)


def _report(progress: Progress | None, seconds: float, left_s: float) -> None:
    if progress:
        progress(int(seconds - left_s), int(seconds))


def _gains(kinds: Sequence[Unknown], measure: Measure) -> Array:
    return np.asarray(sum(measure.alone(kind) for kind in kinds))


class _Insertion:
    """Where in a route each pair would cost least.

    Attributes
    ----------
    least_s
        Seconds that each pair would add to the route, shape (pairs,).
    """

    def __init__(self, moves: Moves, count: int, order: Sequence[int]) -> None:
        self._moves = moves
        self.least_s = np.full(count, np.inf)
        self._place = np.zeros(count, np.int64)
        self._ends: list[tuple[int, int]] = []
        for ends in pairwise([_NOWHERE, *order, _NOWHERE]):
            self._append(ends)

    def insert(self, pair: int) -> None:
        """Put a pair where it costs least."""
        place = int(self._place[pair])
        before, after = self._ends[place]
        self._ends[place] = (before, pair)
        orphans = np.flatnonzero(self._place == place)
        cost = self._cost(np.array(self._ends)[:, :, None], orphans)
        self._place[orphans] = cost.argmin(axis=0)
        self.least_s[orphans] = cost.min(axis=0)
        self._offer(place, np.arange(len(self.least_s)))
        self._append((pair, after))

    def _append(self, ends: tuple[int, int]) -> None:
        self._ends.append(ends)
        self._offer(len(self._ends) - 1, np.arange(len(self.least_s)))

    def _offer(self, place: int, pairs: Indices) -> None:
        cost = self._cost(np.array([self._ends[place]])[:, :, None], pairs)[0]
        better = cost < self.least_s[pairs]
        self.least_s[pairs[better]] = cost[better]
        self._place[pairs[better]] = place

    def _cost(self, ends: Indices, pairs: Indices) -> Array:
        """Return what pairs would add between ends, shape (m, 2, 1): seconds, shape (m, n)."""
        before, after = ends[:, 0], ends[:, 1]
        has_before, has_after = before != _NOWHERE, after != _NOWHERE
        there_s = np.where(has_before, self._moves.between(before, pairs), 0.0)
        onward_s = np.where(has_after, self._moves.between(pairs, after), 0.0)
        saved_s = np.where(has_before & has_after, self._moves.between(before, after), 0.0)
        return np.asarray(there_s + onward_s - saved_s)
