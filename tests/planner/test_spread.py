import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.candidates import candidates_named, paper_candidates
from planner.criteria import CRITERIA, PRIOR_CRITERIA, criterion_named
from planner.field import Field, paper_field
from planner.spread import RandomChoice, pair_distances
from planner.subset import angles_between, farthest_points, least_energy

BLIND = [name for name in CRITERIA if name not in PRIOR_CRITERIA]
DIRECTIONS = paper_candidates().directions


def some_field(seed):
    rng = np.random.default_rng(seed)
    allowed = rng.random((25, 81)) < 0.7
    return Field(candidates_named("rings:0x1,30x8,60x16"), paper_candidates(), allowed)


@pytest.mark.parametrize("name", BLIND)
@given(seed=st.integers(0, 2**32 - 1), lights=st.integers(1, 12), views=st.integers(1, 12))
def test_a_product_has_the_sizes_asked_for(name, seed, lights, views):
    field = some_field(seed)
    measured = criterion_named(name).product(field, lights, views).measured
    light, view = measured.any(axis=1), measured.any(axis=0)
    assert (light.sum(), view.sum()) == (lights, views)
    assert (measured == np.outer(light, view)).all()


@pytest.mark.parametrize("name", BLIND)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 40))
def test_pairs_are_as_many_as_asked_for_and_allowed(name, seed, count):
    field = some_field(seed)
    measured = criterion_named(name).pairs(field, count).measured
    assert measured.sum() == count
    assert not (measured & ~field.allowed).any()


@pytest.mark.parametrize("name", BLIND)
def test_all_that_is_allowed_can_be_asked_for(name):
    field = some_field(7)
    measured = criterion_named(name).pairs(field, int(field.allowed.sum())).measured
    assert (measured == field.allowed).all()


def test_a_seed_gives_one_choice():
    one, same, other = (RandomChoice(seed).pairs(paper_field(), 50).measured for seed in (3, 3, 4))
    assert (one == same).all()
    assert (one != other).any()


def energy(directions):
    chord = np.linalg.norm(directions[:, None] - directions[None], axis=-1)
    return np.sum(chord[np.triu_indices(len(directions), 1)] ** -3.0)


@pytest.mark.parametrize("count", [5, 14, 30])
def test_least_energy_beats_farthest_points_and_chance(count):
    least = energy(DIRECTIONS[least_energy(DIRECTIONS, count)])
    rng = np.random.default_rng(0)
    drawn = [energy(DIRECTIONS[rng.choice(81, count, replace=False)]) for _ in range(100)]
    assert least < min(drawn)
    assert least <= energy(DIRECTIONS[farthest_points(DIRECTIONS, count, 0)])


def test_views_keep_away_from_the_lights_by_energy():
    measured = criterion_named("energy").product(paper_field(), 14, 14).measured
    assert paper_field().reciprocal(measured) == 0
    assert not (measured.any(axis=0) & measured.any(axis=1)).any()


def test_one_candidate_is_enough():
    one = candidates_named("rings:20x1")
    field = Field(one, one, np.ones((1, 1), bool))
    for name in BLIND:
        assert criterion_named(name).product(field, 1, 1).measured.all()
        assert criterion_named(name).pairs(field, 1).measured.all()


@given(st.integers(0, 80), st.integers(0, 80))
def test_distances_of_pairs_know_reciprocity(light, view):
    distance = pair_distances(paper_field(), (light, view))
    assert distance[light, view] == pytest.approx(0, abs=1e-7)
    assert distance[view, light] == pytest.approx(0, abs=1e-7)
    np.testing.assert_allclose(distance, distance.T, atol=1e-7)
    apart = angles_between(DIRECTIONS, DIRECTIONS)
    assert distance[light, 3] <= apart[view, 3] + 1e-9


def test_pairs_far_apart_are_farther_than_drawn_ones():
    def nearest(measured):
        pairs = np.argwhere(measured)
        apart = [pair_distances(paper_field(), tuple(pair))[measured] for pair in pairs]
        return min(np.sort(distance)[1] for distance in apart)

    far, drawn = (
        nearest(criterion_named(name).pairs(paper_field(), 30).measured)
        for name in ("farthest", "random")
    )
    assert far > 2 * drawn
