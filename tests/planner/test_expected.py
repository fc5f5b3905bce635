from dataclasses import replace

import numpy as np
import pytest

from gonio.protocols import PriorKind
from gonio.rig import default_rig
from nnbrdf.prior import MaterialPrior
from planner.beliefs import RememberedPrior
from planner.candidates import candidates_named
from planner.expected import ExpectedError
from planner.field import Field, cosine_demand
from planner.information import NOISE
from planner.make import make_plan
from planner.sweep import Design, Sweep, designs_of, run_sweep

SET = candidates_named("rings:0x1,30x6,60x8")
FIELD = Field(SET, SET, np.ones((15, 15), bool))


@pytest.fixture(scope="module")
def prior():
    return MaterialPrior.generate(examples=60)


def dense_error(kinds, measured, weights):
    """Return the error by the textbook's formula, without the factor's help."""
    left = 0.0
    for kind in kinds:
        factor = kind.factor[kind.which]
        covariance = factor @ factor.T
        seen = covariance[np.ix_(measured, measured)] + NOISE * np.eye(len(measured))
        known = covariance[:, measured] @ np.linalg.solve(seen, covariance[measured])
        left += kind.share * np.average(np.diag(covariance - known), weights=weights)
    return np.sqrt(left)


@pytest.mark.parametrize("demand", [None, cosine_demand(SET, SET)], ids=["alike", "cosine"])
@pytest.mark.parametrize("count", [0, 1, 20])
def test_it_is_the_posterior_standard_deviation(prior, demand, count):
    field = Field(SET, SET, np.ones((15, 15), bool), demand)
    measured = np.random.default_rng(count).choice(225, count, replace=False)
    weights = None if demand is None else demand.ravel()
    expected = dense_error(prior.kinds(*field.pairs, 400), measured, weights)
    assert ExpectedError(field, prior).after(measured) == pytest.approx(expected, rel=1e-6)


def test_more_pairs_never_hurt(prior):
    judge = ExpectedError(FIELD, prior)
    order = np.random.default_rng(0).permutation(225)
    errors = [judge.after(order[:count]) for count in (0, 1, 5, 25, 100, 225)]
    assert (np.diff(errors) < 0).all()
    assert judge.after(order[:0]) == errors[0]


def test_where_nothing_counts_there_is_no_error(prior):
    field = Field(SET, SET, np.ones((15, 15), bool), np.zeros((15, 15)))
    assert ExpectedError(field, prior).after(np.array([3, 4])) == 0.0


def test_one_factor_serves_all_and_is_what_a_shorter_one_would_be(prior):
    asked = []

    class Counting:
        def kinds(self, light, view, rank):
            asked.append(rank)
            return prior.kinds(light, view, rank)

    known = RememberedPrior(Counting, 60)
    for rank in (20, 60, 20):
        for kind, own in zip(
            known.kinds(*FIELD.pairs, rank), prior.kinds(*FIELD.pairs, rank), strict=True
        ):
            assert isinstance(kind, PriorKind)
            assert np.allclose(kind.factor, own.factor)
    other = Field(SET.part(SET.theta_deg < 50), SET, np.ones((7, 15), bool))
    assert len(known.kinds(*other.pairs, 20)[0].which) == 105
    assert asked == [60, 60]


def swept(prior, designs, rig=None, workers=1):
    known = RememberedPrior(lambda: prior, 400)
    judge = ExpectedError(FIELD, known)
    steps = []

    def plan_of(**settings):
        return make_plan(
            rig or default_rig(), prior=lambda: known, view_candidates=SET, light_candidates=SET,
            **settings,
        )  # fmt: skip

    sweep = run_sweep(designs, plan_of, FIELD, judge, lambda *step: steps.append(step), workers)
    assert steps[-1] == (len(designs), len(designs))
    return sweep


@pytest.mark.parametrize("criterion", ["i-optimal", "d-optimal"])
def test_errors_fall_with_more_shots_and_time_rises(prior, criterion):
    designs = [Design(criterion, pairs=pairs) for pairs in (4, 16, 64, 225)]
    sweep = swept(prior, designs)
    assert [each.shots for each in sweep.outcomes] == [4, 16, 64, 225]
    assert (np.diff([each.error for each in sweep.outcomes]) < 0).all()
    assert (np.diff([each.seconds for each in sweep.outcomes]) > 0).all()
    assert all(each.planning_s > 0 for each in sweep.outcomes)


def test_side_by_side_is_the_same(prior):
    designs = [Design(name, pairs=9) for name in ("i-optimal", "energy", "random")]
    one, two = (swept(prior, designs, workers=workers).outcomes for workers in (1, 2))
    assert [replace(each, planning_s=0.0) for each in one] == [
        replace(each, planning_s=0.0) for each in two
    ]


def test_i_optimal_pairs_expect_less_error_than_random_ones(prior):
    designs = [Design(name, pairs=25) for name in ("i-optimal", "random", "farthest")]
    best, *others = (each.error for each in swept(prior, designs).outcomes)
    assert best < min(others)


def test_what_cannot_be_planned_is_told(prior):
    data = default_rig().model_dump()
    data["axis"]["view_theta"]["max_deg"] = 45.0
    rig = type(default_rig()).model_validate(data)
    designs = [Design("random", side=side) for side in (4, 10)]
    sweep = swept(prior, designs, rig)
    assert isinstance(sweep, Sweep)
    assert [each.design for each in sweep.outcomes] == designs[:1]
    ((refused, why),) = sweep.refused
    assert refused == designs[1]
    assert "reaches" in why or "views" in why


def test_designs_go_as_far_as_the_field():
    labels = {design.label for design in designs_of(["random"], FIELD)}
    assert labels == {
        "4 x 4",
        "6 x 6",
        "8 x 8",
        "10 x 10",
        "14 x 14",
        "16",
        "36",
        "64",
        "100",
        "196",
    }
