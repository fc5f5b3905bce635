import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.directions import from_degrees
from nnbrdf.prior import MaterialPrior, Pairs
from nnbrdf.prior.family import grid_pairs, pivoted_cholesky
from nnbrdf.prior.generated import GeneratedMaterials
from nnbrdf.prior.kernels import exchange, exchange_variance

angles = st.tuples(st.floats(0, 90), st.floats(0, 360), st.floats(0, 90), st.floats(0, 360))
GRAINED = GeneratedMaterials.draw(40, 5, isotropic=False)
PLAIN = GeneratedMaterials.draw(40, 5, isotropic=True)
PRIOR = MaterialPrior.generate(examples=60)


def pairs_of(*degrees):
    light_theta, light_phi, view_theta, view_phi = np.array(degrees, float).T
    return Pairs.of(from_degrees(light_theta, light_phi), from_degrees(view_theta, view_phi))


def swapped(pairs):
    return Pairs.of(pairs.view, pairs.light)


@given(angles)
def test_generated_materials_are_positive_and_reciprocal(degrees):
    pairs = pairs_of(degrees)
    there = GRAINED.evaluate(pairs)
    assert (there > 0).all()
    assert np.isfinite(there).all()
    assert GRAINED.evaluate(swapped(pairs)) == pytest.approx(there, rel=1e-9)


@given(angles, st.floats(0, 360))
def test_isotropic_ones_may_be_turned_and_mirrored(degrees, turn):
    light_theta, light_phi, view_theta, view_phi = degrees
    there = PLAIN.evaluate(pairs_of(degrees))
    turned = PLAIN.evaluate(pairs_of((light_theta, light_phi + turn, view_theta, view_phi + turn)))
    mirrored = PLAIN.evaluate(pairs_of((light_theta, -light_phi, view_theta, -view_phi)))
    assert turned == pytest.approx(there, rel=1e-6)
    assert mirrored == pytest.approx(there, rel=1e-6)


def test_some_grained_ones_may_not_be_turned():
    there = GRAINED.evaluate(pairs_of((55, 0, 20, 180)))
    turned = GRAINED.evaluate(pairs_of((55, 90, 20, 270)))
    assert (np.abs(np.log(turned / there)) > 0.1).any()


def test_the_same_seed_draws_the_same_materials():
    again = GeneratedMaterials.draw(40, 5, isotropic=False)
    assert (
        again.evaluate(grid_pairs().part(slice(50)))
        == GRAINED.evaluate(grid_pairs().part(slice(50)))
    ).all()


@pytest.mark.slow
def test_equal_pairs_are_found():
    grid = grid_pairs()
    reciprocal, which = grid.reciprocal()
    assert len(reciprocal) == 81 * 82 // 2
    rotated, turned = grid.rotated()
    assert len(rotated) == 364
    for distinct, index in ((reciprocal, which), (rotated, turned)):
        there = PLAIN.evaluate(distinct)[index]
        assert there == pytest.approx(PLAIN.evaluate(grid), rel=1e-5)


EXTREME = [
    (0, 0, 0, 0),
    (0, 123, 45, 10),
    (90, 0, 90, 180),
    (90, 0, 90, 0),
    (89.9, 0, 89.9, 180),
    (89.9, 10, 0, 0),
]


def test_extreme_pairs_have_features_and_values():
    pairs = pairs_of(*EXTREME)
    for family in PRIOR.families:
        traits = family.traits(pairs)
        for array in (traits.examples, traits.mean, traits.features):
            assert np.isfinite(array).all()


@given(st.integers(0, 2**32 - 1))
def test_covariances_are_positive_and_have_their_variances(seed):
    rng = np.random.default_rng(seed)
    degrees = rng.uniform(0, [90, 360, 90, 360], (25, 4))
    pairs = pairs_of(*degrees)
    for family in PRIOR.families:
        traits = family.traits(pairs)
        parts, variances = family.covariances(traits, traits, 1.0), family.variances(traits)
        for whole, diagonal in zip(parts, variances, strict=True):
            assert np.diag(whole) == pytest.approx(diagonal, abs=1e-9)
            assert np.linalg.eigvalsh(whole).min() > -1e-8


@given(angles)
def test_the_breach_turns_round_with_the_pair(degrees):
    pairs, other = pairs_of(degrees), pairs_of((10, 20, 60, 200))
    for isotropic in (True, False):
        there = exchange(pairs, other, isotropic=isotropic)
        back = exchange(swapped(pairs), other, isotropic=isotropic)
        assert back == pytest.approx(-there, abs=1e-12)
        assert exchange_variance(pairs, isotropic=isotropic) == pytest.approx(
            np.diag(exchange(pairs, pairs, isotropic=isotropic)), abs=1e-12
        )


def test_a_pivoted_factor_gives_the_covariance_back():
    rng = np.random.default_rng(0)
    root = rng.normal(size=(60, 8))
    covariance = root @ root.T
    factor = pivoted_cholesky(np.diag(covariance).copy(), lambda i: covariance[:, i], 40)
    assert factor.shape[1] == 8
    assert factor @ factor.T == pytest.approx(covariance, abs=1e-8)
    part = pivoted_cholesky(np.diag(covariance).copy(), lambda i: covariance[:, i], 4)
    left = np.linalg.eigvalsh(covariance - part @ part.T)
    assert left.min() > -1e-8


def test_kinds_factor_the_covariance():
    grid = grid_pairs().part(slice(0, 6561, 40))
    for kind, family in zip(PRIOR.kinds(grid.light, grid.view, 400), PRIOR.families, strict=True):
        traits = family.traits(grid)
        whole = family.covariances(traits, traits, 1.0)
        expected = whole.examples + 0.03 * whole.smooth
        factor = kind.factor[kind.which]
        assert factor @ factor.T == pytest.approx(expected, abs=1e-5)
    assert sum(kind.share for kind in PRIOR.kinds(grid.light, grid.view, 5)) == pytest.approx(1)
