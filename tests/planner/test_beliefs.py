import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.errors import BadInputError
from gonio.protocols import PriorKind
from planner.beliefs import IsotropicOnly, RememberedPrior
from planner.candidates import Candidates
from planner.field import Field
from planner.information import NOISE
from planner.scene.expected import expected_error
from planner.scene.use import NOT_ASKED, SAME_AZIMUTH, Use

LIGHTS, VIEWS, RANK = 3, 4, 5


def kind_of(name, share, seed):
    factor = np.random.default_rng(seed).normal(size=(LIGHTS * VIEWS, RANK))
    return PriorKind(name, share, factor, np.arange(LIGHTS * VIEWS))


KINDS = [kind_of("isotropic", 0.8, 1), kind_of("anisotropic", 0.2, 2)]


class Told:
    """A prior that counts how often it is asked."""

    def __init__(self, kinds):
        self.told, self.asked = kinds, 0

    def kinds(self, light, view, rank):
        self.asked += 1
        return self.told


def dense_deviation(kind, rows):
    """Return the posterior deviation by the textbook's formula, without the factor's trick."""
    covariance = kind.factor @ kind.factor.T
    cross = covariance[:, rows]
    inner = covariance[np.ix_(rows, rows)] + NOISE * np.eye(len(rows))
    return np.sqrt(np.diag(covariance - cross @ np.linalg.solve(inner, cross.T)).clip(min=0))


@given(st.sets(st.integers(0, LIGHTS * VIEWS - 1), max_size=6), st.integers(0, 99))
def test_the_expected_error_is_that_of_a_gaussian_process(rows, seed):
    random = np.random.default_rng(seed)
    measured = np.zeros((LIGHTS, VIEWS), bool)
    measured.flat[list(rows)] = True
    demand = random.dirichlet(np.ones(LIGHTS * VIEWS)).reshape(LIGHTS, VIEWS)
    asked = demand > np.median(demand)
    deviation = sum(kind.share * dense_deviation(kind, sorted(rows)) for kind in KINDS)
    found = expected_error(KINDS, measured, demand, asked)
    assert found.inside == pytest.approx(deviation @ demand.ravel(), abs=1e-6)
    assert found.outside == pytest.approx(deviation[~asked.ravel()].mean(), abs=1e-6)


def test_where_all_is_asked_for_there_is_no_outside():
    every = np.ones((LIGHTS, VIEWS), bool)
    assert expected_error(KINDS, every, every / every.size, every).outside is None


def test_a_prior_is_made_when_asked_and_asked_once():
    prior, light, view = Told(KINDS), np.eye(3), np.eye(3)[::-1].copy()
    remembered = RememberedPrior(lambda: prior)
    assert prior.asked == 0
    for _ in range(2):
        told = remembered.kinds(light, view, 9)
        assert all((a.factor == b.factor).all() for a, b in zip(told, KINDS, strict=True))
    assert prior.asked == 1
    remembered.kinds(view, light, 9)
    remembered.kinds(light, view, 8)
    assert prior.asked == 2
    remembered.kinds(light, view, 10)
    assert prior.asked == 3


def test_isotropic_only_has_the_whole_share():
    (kind,) = IsotropicOnly(Told(KINDS)).kinds(np.eye(3), np.eye(3), 9)
    assert (kind.name, kind.share) == ("isotropic", 1.0)


def test_a_prior_without_isotropic_materials_says_so():
    with pytest.raises(BadInputError, match="no isotropic kind"):
        IsotropicOnly(Told(KINDS[1:])).kinds(np.eye(3), np.eye(3), 9)


RING = Candidates("ring", np.array([0.0, 30.0, 30.0, 60.0]), np.array([0.0, 0.0, 180.0, 90.0]))


def test_without_a_scene_all_pairs_count_alike():
    use = Use(isotropic=True)
    assert use.demand(RING, RING) == pytest.approx(np.full((4, 4), 1 / 16))
    assert use.asked(RING, RING).all()
    assert list(use.omissions()) == [SAME_AZIMUTH]
    assert list(Use().omissions()) == []
    assert NOT_ASKED not in use.omissions()


def test_of_each_ring_the_light_with_most_reach_stays():
    allowed = np.ones((4, 4), bool)
    leave_out = Use(isotropic=True).omissions()[SAME_AZIMUTH]
    assert leave_out(Field(RING, RING, allowed)).any(axis=1).tolist() == [False, False, True, False]
    allowed[1, 0] = False
    assert leave_out(Field(RING, RING, allowed)).any(axis=1).tolist() == [False, True, False, False]
