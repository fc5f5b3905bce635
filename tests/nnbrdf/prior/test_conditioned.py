"""What samples leave unknown, as a prior for the planner."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gonio.directions import from_degrees
from gonio.samples import Samples
from nnbrdf.prior import MaterialPrior, Pairs
from nnbrdf.prior.conditioned import Belief, ConditionedPrior
from nnbrdf.prior.family import grid_pairs
from nnbrdf.prior.infer import infer
from nnbrdf.prior.material_prior import EXPECTED

PRIOR = MaterialPrior.generate(examples=80)
GRID = grid_pairs()
BREACH = EXPECTED._replace(exchange=0.03)


def directions(seed, count):
    rng = np.random.default_rng(seed)
    return from_degrees(rng.uniform(0, 75, count), rng.uniform(0, 360, count))


def samples_of(pairs, value=0.2):
    values = np.full((len(pairs), 3), value)
    return Samples.from_values(pairs.light, pairs.view, values, sigma=0.01 * values)


def pairs_of(seed, count):
    return Pairs.of(directions(seed, count), directions(seed + 1, count))


def conditioned(sites, samples=None):
    samples = samples or samples_of(sites)
    return ConditionedPrior.of(PRIOR.families, infer(PRIOR.families, samples), sites)


def dense(belief, pairs, sites, noise):
    """Return the conditional covariance by the textbook, all of it at once."""
    family, setting, _ = belief
    a, s = family.traits(pairs), family.traits(sites)
    inner = family.covariance(s, s, setting) + np.diag(noise + setting.noise)
    across = family.covariance(a, s, setting)
    return family.covariance(a, a, setting) - across @ np.linalg.solve(inner, across.T)


@pytest.mark.parametrize("setting", [EXPECTED, BREACH], ids=["reciprocal", "breached"])
@pytest.mark.parametrize("number", [0, 1], ids=["isotropic", "anisotropic"])
def test_the_factor_is_that_of_the_conditional_covariance(setting, number):
    sites, pairs = pairs_of(1, 25), pairs_of(7, 30)
    # a pair and its reverse are one where the material keeps reciprocity, two where it does not
    pairs = Pairs.of(*(np.concatenate(e) for e in ((pairs.light, pairs.view), (pairs.view, pairs.light))))  # fmt: skip  # noqa: E501
    belief = Belief(PRIOR.families[number], setting, 1.0)
    known = replace(conditioned(sites), told=(belief,))
    kind, *_ = known.kinds(pairs.light, pairs.view, 200)
    told = (kind.factor @ kind.factor.T)[np.ix_(kind.which, kind.which)]
    np.testing.assert_allclose(told, dense(belief, pairs, sites, known.noise), atol=1e-5)
    assert len(kind.factor) == (30 if setting is EXPECTED else 60)


def test_shares_count_what_is_unknown_and_half_of_what_was_believed_before():
    known = conditioned(pairs_of(3, 40))
    kinds = known.kinds(GRID.light, GRID.view, 100)
    left = [((kind.factor**2).sum(1) + kind.rest)[kind.which].mean() for kind in kinds]
    told, before = kinds[:-2], kinds[-2:]
    assert len(told) == len(known.told)
    parts = [belief.share * part for belief, part in zip(known.told, left, strict=False)]
    assert [kind.share for kind in told] == pytest.approx([0.5 * p / sum(parts) for p in parts])
    whole = [
        family.variances(family.traits(GRID)).total(EXPECTED).mean() for family in PRIOR.families
    ]
    parts = [0.8 * left[-2] / whole[0], 0.2 * left[-1] / whole[1]]
    assert [kind.share for kind in before] == pytest.approx([0.5 * p / sum(parts) for p in parts])


@settings(max_examples=10)
@given(seed=st.integers(0, 1000), more=st.integers(1, 20))
def test_what_is_on_its_way_only_lowers_what_is_expected(seed, more):
    known = conditioned(pairs_of(3, 20))
    coming = pairs_of(seed, more)
    after = known.deviation_after(coming.light, coming.view)
    assert 0 < after <= known.deviation


def test_samples_to_come_count_whatever_they_will_say():
    taken, coming = pairs_of(3, 20), pairs_of(50, 20)
    both = Pairs.of(*(np.concatenate(e) for e in (
        (taken.light, coming.light), (taken.view, coming.view)
    )))  # fmt: skip
    samples = samples_of(taken)
    waiting, alone = conditioned(both, samples), conditioned(taken, samples)
    assert waiting.deviation == alone.deviation
    nothing = np.empty((0, 3))
    assert waiting.deviation_after(nothing, nothing) == pytest.approx(
        alone.deviation_after(coming.light, coming.view)
    )
    kinds = [each.kinds(coming.light, coming.view, 40) for each in (waiting, alone)]
    there, here = ([(kind.factor**2).sum() for kind in each] for each in kinds)
    assert all(a < 0.5 * b for a, b in zip(there, here, strict=True))


def test_the_brightness_that_is_expected():
    known = conditioned(pairs_of(3, 40))
    light, view = directions(90, 10), directions(91, 10)
    mean, deviation = known.expected(light, view)
    assert mean.shape == deviation.shape == (10,)
    # of f + 0.01 white, white being four times the median
    np.testing.assert_allclose(mean, np.log(0.2 + 0.008), atol=0.2)
    assert (np.abs(np.log(0.208) - mean) < 3 * deviation).all()
    told = known.inference.predict(light, view)
    np.testing.assert_allclose(np.exp(mean), told.median.mean(axis=1) + 0.008, rtol=0.05)


def test_a_color_widens_what_is_expected():
    sites = pairs_of(3, 40)
    values = np.tile([0.1, 0.2, 0.4], (40, 1))
    colored = Samples.from_values(sites.light, sites.view, values, sigma=0.01 * values)
    mean, deviation = conditioned(sites, colored).expected(sites.light, sites.view)
    np.testing.assert_allclose(mean, np.log(0.2), atol=0.1)
    np.testing.assert_allclose(deviation, np.std(np.log([0.1, 0.2, 0.4])), rtol=0.1)


def test_equal_samples_make_equal_factors():
    one, other = (conditioned(pairs_of(3, 20)).kinds(GRID.light, GRID.view, 60) for _ in range(2))
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a.factor, b.factor)
