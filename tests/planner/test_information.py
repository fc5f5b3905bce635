from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.directions import paper_directions
from gonio.errors import BadInputError
from gonio.protocols import PriorKind
from gonio.rig import default_rig
from nnbrdf.prior import MaterialPrior, Pairs
from nnbrdf.prior.material_prior import EXPECTED
from planner.bound import least_left
from planner.candidates import paper_candidates
from planner.criteria import criterion_named
from planner.field import Field, cosine_demand
from planner.information import NOISE, Unknown
from planner.make import make_plan
from planner.optimal import _ENTROPY, _VARIANCE, IOptimal, unknown_of
from planner.search import best_pairs, best_product
from planner.subset import farthest_points

DIRECTIONS = paper_directions()
PAPER = paper_candidates()


def whole(allowed=None, demand=None):
    every = np.ones((81, 81), bool) if allowed is None else allowed
    return Field(PAPER, PAPER, every, demand)


@pytest.fixture(scope="module")
def prior():
    return MaterialPrior.generate(examples=200)


def random_kind(rng, pairs=60, rank=12, share=1.0):
    factor = rng.normal(size=(pairs // 2, rank)) * np.geomspace(1, 0.01, rank)
    which = np.concatenate([np.arange(pairs // 2)] * 2)
    return PriorKind("any", share, factor, which)


def variance_left(kind, measured, demand=None):
    """Return the integrated posterior variance by the textbook's formula, over the prior's."""
    factor = kind.factor[kind.which]
    demand = np.ones(len(factor)) if demand is None else demand
    covariance = factor @ factor.T
    seen = covariance[np.ix_(measured, measured)] + NOISE * np.eye(len(measured))
    known = covariance[:, measured] @ np.linalg.solve(seen, covariance[measured])
    return kind.share * (1 - np.diag(known) @ demand / (np.diag(covariance) @ demand))


@given(st.integers(0, 2**32 - 1))
def test_what_is_left_is_the_posterior_variance(seed):
    rng = np.random.default_rng(seed)
    kind = random_kind(rng)
    demand = rng.random(60) ** 4
    measured = rng.choice(60, 9, replace=False)
    unknown = Unknown(kind, demand)
    unknown.learn(measured[:4])
    unknown.learn(measured[4:])
    assert unknown.remaining == pytest.approx(variance_left(kind, measured, demand), rel=1e-6)
    again = Unknown(kind, demand)
    again.forget(measured)
    assert again.remaining == pytest.approx(unknown.remaining, rel=1e-6)
    assert again.gains() == pytest.approx(unknown.gains(), rel=1e-5, abs=1e-9)
    assert again.slopes() == pytest.approx(unknown.slopes(), rel=1e-5, abs=1e-9)


@given(st.integers(0, 2**32 - 1))
def test_steps_of_one_pair_end_where_all_at_once_do(seed):
    rng = np.random.default_rng(seed)
    kind = random_kind(rng)
    pairs = rng.choice(60, 8, replace=False)
    unknown, again = Unknown(kind), Unknown(kind)
    for pair in pairs:
        unknown.turn(pair, known=True)
    for pair in pairs[:3]:
        unknown.turn(pair, known=False)
    again.forget(pairs[3:])
    assert unknown.remaining == pytest.approx(again.remaining, rel=1e-6)
    assert unknown.gains() == pytest.approx(again.gains(), rel=1e-5, abs=1e-9)
    assert unknown.entropy_gains() == pytest.approx(again.entropy_gains(), rel=1e-5, abs=1e-9)
    for state in ("_covariance", "_middle"):
        assert getattr(unknown, state) == pytest.approx(getattr(again, state), abs=1e-7)


@given(st.integers(0, 2**32 - 1))
def test_a_slope_is_the_derivative_for_a_weight(seed):
    rng = np.random.default_rng(seed)
    kind = random_kind(rng)
    kind = kind._replace(rest=rng.random(30) ** 8)
    weights = rng.random(60)
    unknown, more = Unknown(kind), Unknown(kind)
    unknown.weigh(weights)
    step = 1e-6 * (np.arange(60) == 7)
    more.weigh(weights + step)
    slope = (unknown.remaining - more.remaining) / 1e-6
    assert unknown.slopes()[7] == pytest.approx(slope, rel=1e-3, abs=1e-9)
    whole = Unknown(kind)
    whole.weigh((np.arange(60) < 5).astype(float))
    again = Unknown(kind)
    again.forget(np.arange(5))
    assert whole.remaining == pytest.approx(again.remaining)


@given(st.integers(0, 2**32 - 1), st.integers(1, 4))
def test_no_choice_beats_the_bound(seed, count):
    rng = np.random.default_rng(seed)
    kinds = [random_kind(rng, pairs=10, rank=4, share=share) for share in (0.7, 0.3)]
    allowed = rng.random(10) < 0.8
    allowed[:count] = True
    unknown = [Unknown(kind) for kind in kinds]
    chosen = best_pairs(unknown, allowed, count, _VARIANCE)
    bound = least_left(unknown, allowed, chosen)
    best = min(
        sum(variance_left(kind, np.array(choice)) for kind in kinds)
        for choice in combinations(np.flatnonzero(allowed), count)
    )
    assert bound <= best * (1 + 1e-9)
    greedy = best_pairs([Unknown(kind) for kind in kinds], allowed, count, _VARIANCE, sweeps=0)
    left = [sum(variance_left(kind, pairs) for kind in kinds) for pairs in (chosen, greedy)]
    assert best * (1 - 1e-9) <= left[0] <= left[1] * (1 + 1e-6)


@given(st.integers(0, 2**32 - 1))
def test_a_gain_is_what_measuring_takes_off(seed):
    rng = np.random.default_rng(seed)
    kind = random_kind(rng)
    unknown = Unknown(kind)
    unknown.learn(rng.choice(60, 3))
    blocks = rng.choice(60, (5, 4))
    counted = rng.random((5, 4)) < 0.7
    for block, counts, gain in zip(
        blocks, counted, unknown.block_gains(blocks, counted), strict=True
    ):
        after = Unknown(kind)
        after._know(unknown._covariance)
        after.learn(block[counts])
        assert unknown.remaining - after.remaining == pytest.approx(gain, rel=1e-6, abs=1e-9)
    alone = unknown.block_gains(np.arange(60)[:, None], np.ones((60, 1), bool))
    assert unknown.gains() == pytest.approx(alone)


def test_what_the_factor_leaves_out_is_no_knowledge(prior):
    measured = IOptimal(lambda: prior).pairs(whole(), 64)
    chosen = np.flatnonzero(measured.measured)
    family = prior.families[0]
    distinct, which = family.distinct(Pairs.of(*whole().pairs))
    traits = family.traits(distinct)
    covariance = family.covariance(traits, traits, EXPECTED)
    exact = variance_left(
        PriorKind("", 1.0, np.linalg.cholesky(covariance + 1e-9 * np.eye(len(distinct))), which),
        chosen,
    )
    for rank in (60, 150):
        unknown = Unknown(prior.kinds(*whole().pairs, rank)[0]._replace(share=1.0))
        unknown.forget(chosen)
        assert unknown.remaining == pytest.approx(exact, rel=0.25)
        for pair in chosen[:20]:
            unknown.turn(pair, known=False)
        unknown.learn(chosen[:20])
        assert unknown.remaining == pytest.approx(exact, rel=0.25)


def test_pairs_that_symmetry_makes_equal_are_measured_once(prior):
    plan = make_plan(default_rig(), criterion="i-optimal", shots=60, prior=lambda: prior)
    assert len(plan.shots) == 60
    assert plan.selection.reciprocal_pairs == 0
    assert 0 < plan.selection.variance_left < 0.1


def test_both_ways_round_are_taken_in_turn(prior):
    choice = IOptimal(lambda: prior).pairs(whole(), 100)
    upper = np.triu(choice.measured, k=1).sum()
    assert 30 < upper < 70


def test_more_pairs_leave_less(prior):
    judge = IOptimal(lambda: prior)
    choices = [judge.pairs(whole(), n) for n in (1, 8, 64, 196)]
    left = [choice.variance_left for choice in choices]
    assert (np.diff(left) < 0).all()
    assert left[-1] < 0.01 < 0.2 < left[0]
    assert all(0 <= choice.variance_bound <= choice.variance_left for choice in choices)
    assert choices[-1].variance_bound > 0.8 * left[-1]


def test_a_product_beats_farthest_points_and_pairs_beat_the_product(prior):
    light, view = np.repeat(DIRECTIONS, 81, axis=0), np.tile(DIRECTIONS, (81, 1))
    kinds = prior.kinds(light, view, 100)
    allowed = np.ones((81, 81), bool)

    def left(measured):
        unknown = [Unknown(kind) for kind in kinds]
        for each in unknown:
            each.forget(np.flatnonzero(measured))
        return sum(each.remaining for each in unknown)

    far = np.zeros_like(allowed)
    points = farthest_points(DIRECTIONS, 8, 0)
    far[np.ix_(points, points)] = True
    product = np.zeros_like(allowed)
    fresh = [Unknown(kind) for kind in kinds]
    product[np.ix_(*best_product(fresh, allowed, 8, 8, _VARIANCE))] = True
    grown, free = np.zeros_like(allowed), np.zeros_like(allowed)
    for chosen, sweeps in ((grown, 0), (free, 2)):
        fresh = [Unknown(kind) for kind in kinds]
        chosen.flat[best_pairs(fresh, allowed.ravel(), 64, _VARIANCE, sweeps)] = True
    assert left(free) < left(grown) < left(product) < 0.7 * left(far)


def test_what_cannot_be_measured_is_not_counted(prior):
    allowed = np.zeros((81, 81), bool)
    allowed[10:40, 30:60] = True
    choice = IOptimal(lambda: prior).product(whole(allowed), lights=5, views=4)
    light, view = np.nonzero(choice.measured)
    assert set(light) <= set(range(10, 40))
    assert set(view) <= set(range(30, 60))
    assert (len(set(light)), len(set(view))) == (5, 4)
    free = IOptimal(lambda: prior).pairs(whole(allowed), 50)
    assert free.measured.sum() == 50
    assert not (free.measured & ~allowed).any()


@pytest.mark.parametrize("side", [3, 5])
def test_a_product_tells_which_of_its_pairs_cannot_be_taken(prior, side):
    allowed = np.zeros((81, 81), bool)
    allowed[40:45, 50:55] = ~np.eye(5, dtype=bool)
    choice = IOptimal(lambda: prior).product(whole(allowed), side, side)
    light, view = choice.measured.any(axis=1), choice.measured.any(axis=0)
    assert (choice.measured == np.outer(light, view)).all()
    assert choice.measured.sum() == side**2
    # of five by five, all but a diagonal: no three by three is whole
    assert (choice.measured & ~allowed).sum() == {3: 1, 5: 5}[side]


def test_all_pairs_can_be_asked_for(prior):
    allowed = np.zeros((81, 81), bool)
    allowed[:20, :25] = True
    for count in (20 * 25, 20 * 25 - 1):
        choice = IOptimal(lambda: prior).pairs(whole(allowed), count)
        assert choice.measured.sum() == count
        assert not (choice.measured & ~allowed).any()


def test_everything_needs_no_prior():
    def never():
        raise AssertionError

    choices = IOptimal(never).product(whole(), 81, 81), IOptimal(never).pairs(whole(), 6561)
    assert all(choice.measured.all() for choice in choices)
    assert whole().reciprocal(choices[0].measured) == 81 * 80 // 2


def test_demand_draws_shots_to_where_it_is(prior):
    demand = np.zeros((81, 81))
    demand[:, 40:] = 1.0
    asked = IOptimal(lambda: prior).pairs(whole(demand=demand), 40)
    kinds = unknown_of(whole(demand=demand), prior)
    for each in kinds:
        each.forget(np.flatnonzero(IOptimal(lambda: prior).pairs(whole(), 40).measured))
    assert asked.variance_left < 0.95 * sum(each.remaining for each in kinds)


@pytest.mark.parametrize("demand", [np.zeros((81, 81)), cosine_demand(PAPER, PAPER)])
def test_demand_of_nothing_is_met_by_anything(prior, demand):
    choice = IOptimal(lambda: prior).pairs(whole(demand=demand), 9)
    assert choice.measured.sum() == 9
    assert np.isfinite(choice.variance_left)
    assert choice.variance_left == 0 or demand.any()


def test_d_optimal_tells_more_and_leaves_more(prior):
    def judged(name):
        choice = criterion_named(name, lambda: prior).pairs(whole(), 60)
        kinds = prior.kinds(*whole().pairs, 150)
        rows = [kind.factor[kind.which[np.flatnonzero(choice.measured)]] for kind in kinds]
        logs = [np.linalg.slogdet(np.eye(60) + row @ row.T / NOISE)[1] for row in rows]
        return choice.variance_left, sum(logs)

    (left, told), (least, less) = judged("d-optimal"), judged("i-optimal")
    assert told > less
    assert left > least
    kinds = unknown_of(whole(), prior)
    product = best_product(kinds, np.ones((81, 81), bool), 6, 6, _ENTROPY)
    assert [len(side) for side in product] == [6, 6]


BAD = [
    ("no prior", {"criterion": "i-optimal"}, "needs a prior"),
    ("no prior for pairs", {"criterion": "d-optimal", "shots": 5}, "needs a prior"),
    ("no shots", {"criterion": "farthest", "shots": 0}, "give 1 to 6561"),
    ("too many", {"criterion": "farthest", "shots": 6562}, "give 1 to 6561"),
]


@pytest.mark.parametrize(("settings", "says"), [b[1:] for b in BAD], ids=[b[0] for b in BAD])
def test_bad_input(settings, says):
    with pytest.raises(BadInputError, match=says):
        make_plan(default_rig(), **settings)


def test_an_unknown_name_lists_the_known():
    with pytest.raises(BadInputError, match="i-optimal, d-optimal"):
        criterion_named("nearest")
