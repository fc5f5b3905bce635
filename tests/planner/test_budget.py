import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.protocols import PriorKind
from planner.budget import Priced, Terms, _Insertion, pairs_within
from planner.information import Unknown
from planner.optimal import _VARIANCE


class Line:
    """Shots on a line, a second a step; towards the left takes twice as long."""

    def __init__(self, places):
        self.places = np.asarray(places, float)

    def between(self, a, b):
        step = self.places[b] - self.places[a]
        return np.where(step < 0, -2 * step, step)

    def seconds(self, order):
        return float(self.between(np.array(order[:-1], int), np.array(order[1:], int)).sum())


def terms(line, shot_s, fixed_s=5.0):
    def price(pairs):
        # from left to right is the quickest
        order = sorted(pairs, key=lambda pair: line.places[pair])
        return Priced(order, fixed_s + line.seconds(order) + float(shot_s[order].sum()))

    return Terms(line, shot_s, price)


def case(seed, pairs=40):
    rng = np.random.default_rng(seed)
    line = Line(rng.uniform(0, 100, pairs))
    kind = PriorKind("any", 1.0, rng.normal(size=(pairs, 10)), np.arange(pairs))
    return rng, line, kind


@given(st.integers(0, 2**32 - 1), st.floats(6, 400))
def test_the_time_is_kept_and_used(seed, seconds):
    rng, line, kind = case(seed)
    allowed = rng.random(40) < 0.8
    shot_s = rng.uniform(1, 5, 40)
    cost = terms(line, shot_s)
    unknown = [Unknown(kind)]
    priced = pairs_within(unknown, allowed, seconds, cost, _VARIANCE)
    if priced is None:
        first = int(np.argmax(np.where(allowed, Unknown(kind).gains(), -np.inf)))
        assert cost.price([first]).total_s > seconds
        return
    assert priced.total_s <= seconds
    assert len(set(priced.order)) == len(priced.order)
    assert allowed[priced.order].all()
    assert priced == cost.price(priced.order)
    # nothing more would fit where it costs least
    left = [pair for pair in np.flatnonzero(allowed) if pair not in priced.order]
    assert all(cost.price([*priced.order, pair]).total_s > seconds for pair in left)


def test_time_for_all_of_them_takes_all_without_a_search():
    _, line, _ = case(7)
    allowed, shot_s = np.arange(40) % 3 > 0, np.full(40, 2.0)
    cost = terms(line, shot_s)
    whole = cost.price(np.flatnonzero(allowed).tolist())
    seconds = whole.total_s + 1e-9
    assert pairs_within([], allowed, seconds, cost, _VARIANCE) == whole


def test_the_time_used_is_told_as_it_is_used():
    _, line, kind = case(7)
    told = []
    pairs_within(
        [Unknown(kind)], np.ones(40, bool), 60, terms(line, np.full(40, 2.0)), _VARIANCE,
        lambda done, total: told.append((done, total)),
    )  # fmt: skip
    assert {total for _, total in told} == {60}
    assert 40 < max(done for done, _ in told) <= 60


def test_more_time_leaves_less_unknown():
    _, line, kind = case(3)
    cost, left = terms(line, np.full(40, 2.0)), []
    for seconds in (20, 60, 120, 240):
        unknown = Unknown(kind)
        priced = pairs_within([unknown], np.ones(40, bool), seconds, cost, _VARIANCE)
        unknown.forget(np.array(priced.order))
        left.append(unknown.remaining)
    assert (np.diff(left) < 0).all()


def test_what_is_far_is_taken_only_where_it_pays():
    # two pairs tell the same, one lies ten times as far; a third tells nothing
    line = Line([0.0, 5.0, 50.0, 1.0])
    factor = np.array([[3.0, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0.0]])
    unknown = [Unknown(PriorKind("any", 1.0, factor, np.arange(4)))]
    cost = terms(line, np.ones(4), fixed_s=0.0)
    assert pairs_within(unknown, np.ones(4, bool), 7, cost, _VARIANCE).order == [0, 1]


@given(st.integers(0, 2**32 - 1))
def test_insertion_knows_the_cheapest_place(seed):
    rng, line, _ = case(seed, pairs=12)
    order = rng.permutation(12)[:4].tolist()
    route = _Insertion(line, 12, order[:2])
    best = order[:2]
    for pair in order[2:]:
        tried = [[*best[:i], pair, *best[i:]] for i in range(len(best) + 1)]
        quickest = min(tried, key=line.seconds)
        added = line.seconds(quickest) - line.seconds(best)
        assert route.least_s[pair] == pytest.approx(added, abs=1e-9)
        route.insert(pair)
        best = quickest
