import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.directions import paper_directions
from gonio.errors import BadInputError
from gonio.protocols import PriorKind
from gonio.rig import default_rig
from nnbrdf.prior import MaterialPrior
from planner.criteria import IOptimal, criterion_named, reciprocal_pairs
from planner.information import NOISE, Unknown, best_pairs, best_product
from planner.make import make_plan
from planner.subset import farthest_points

DIRECTIONS = paper_directions()


@pytest.fixture(scope="module")
def prior():
    return MaterialPrior.generate(examples=200)


def random_kind(rng, pairs=60, rank=12, share=1.0):
    factor = rng.normal(size=(pairs // 2, rank)) * np.geomspace(1, 0.01, rank)
    which = np.concatenate([np.arange(pairs // 2)] * 2)
    return PriorKind("any", share, factor, which)


def variance_left(kind, measured):
    """Return the integrated posterior variance by the textbook's formula, over the prior's."""
    factor = kind.factor[kind.which]
    covariance = factor @ factor.T
    seen = covariance[np.ix_(measured, measured)] + NOISE * np.eye(len(measured))
    known = covariance[:, measured] @ np.linalg.solve(seen, covariance[measured])
    return kind.share * (1 - np.trace(known) / np.trace(covariance))


@given(st.integers(0, 2**32 - 1))
def test_what_is_left_is_the_posterior_variance(seed):
    rng = np.random.default_rng(seed)
    kind = random_kind(rng)
    measured = rng.choice(60, 9, replace=False)
    unknown = Unknown(kind)
    unknown.learn(measured[:4])
    unknown.learn(measured[4:])
    assert unknown.remaining == pytest.approx(variance_left(kind, measured), rel=1e-6)
    again = Unknown(kind)
    again.forget(measured)
    assert again.remaining == pytest.approx(unknown.remaining, rel=1e-6)
    assert again.gains() == pytest.approx(unknown.gains(), rel=1e-5, abs=1e-9)


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
        after._reach, after._effect, after._left = unknown._reach, unknown._effect, unknown._left
        after.learn(block[counts])
        assert unknown.remaining - after.remaining == pytest.approx(gain, rel=1e-6, abs=1e-9)
    alone = unknown.block_gains(np.arange(60)[:, None], np.ones((60, 1), bool))
    assert unknown.gains() == pytest.approx(alone)


def test_pairs_that_symmetry_makes_equal_are_measured_once(prior):
    plan = make_plan(default_rig(), criterion="i-optimal", shots=60, prior=lambda: prior)
    assert len(plan.shots) == 60
    assert plan.selection.reciprocal_pairs == 0
    assert 0 < plan.selection.variance_left < 0.1


def test_both_ways_round_are_taken_in_turn(prior):
    choice = IOptimal(DIRECTIONS, lambda: prior).pairs(np.ones((81, 81), bool), 100)
    upper = np.triu(choice.measured, k=1).sum()
    assert 30 < upper < 70


def test_more_pairs_leave_less(prior):
    judge = IOptimal(DIRECTIONS, lambda: prior)
    left = [judge.pairs(np.ones((81, 81), bool), n).variance_left for n in (1, 8, 64, 196)]
    assert (np.diff(left) < 0).all()
    assert left[-1] < 0.01 < 0.2 < left[0]


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
    product[np.ix_(*best_product([Unknown(kind) for kind in kinds], allowed, 8, 8))] = True
    free = np.zeros_like(allowed)
    free.flat[best_pairs([Unknown(kind) for kind in kinds], allowed.ravel(), 64)] = True
    assert left(free) < left(product) < 0.7 * left(far)


def test_what_cannot_be_measured_is_not_counted(prior):
    allowed = np.zeros((81, 81), bool)
    allowed[10:40, 30:60] = True
    choice = IOptimal(DIRECTIONS, lambda: prior).product(allowed, 4, 5)
    light, view = np.nonzero(choice.measured)
    assert set(light) <= set(range(10, 40))
    assert set(view) <= set(range(30, 60))
    assert (len(set(light)), len(set(view))) == (5, 4)
    free = IOptimal(DIRECTIONS, lambda: prior).pairs(allowed, 50)
    assert free.measured.sum() == 50
    assert not (free.measured & ~allowed).any()


def test_all_pairs_can_be_asked_for(prior):
    allowed = np.zeros((81, 81), bool)
    allowed[:20, :25] = True
    choice = IOptimal(DIRECTIONS, lambda: prior).pairs(allowed, 20 * 25)
    assert (choice.measured == allowed).all()


def test_everything_needs_no_prior():
    def never():
        raise AssertionError

    choice = IOptimal(DIRECTIONS, never).product(np.ones((81, 81), bool), 81, 81)
    assert choice.measured.all()
    assert reciprocal_pairs(choice.measured) == 81 * 80 // 2


BAD = [
    ("no prior", {"criterion": "i-optimal"}, "needs a prior"),
    ("pairs by distance", {"criterion": "farthest", "shots": 5}, "farthest chooses views"),
    ("no shots", {"criterion": "farthest", "shots": 0}, "give 1 to 6561"),
    ("too many", {"criterion": "farthest", "shots": 6562}, "give 1 to 6561"),
]


@pytest.mark.parametrize(("settings", "says"), [b[1:] for b in BAD], ids=[b[0] for b in BAD])
def test_bad_input(settings, says):
    with pytest.raises(BadInputError, match=says):
        make_plan(default_rig(), **settings)


def test_an_unknown_name_lists_the_known():
    with pytest.raises(BadInputError, match="i-optimal, farthest"):
        criterion_named("nearest", DIRECTIONS)
