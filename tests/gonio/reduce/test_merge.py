from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.reduce.merge import merge
from gonio.reduce.reading import Reading

GAIN = 1.1
READ = 10.0
UP = np.array([0.0, 0.0, 1.0])

rates = st.lists(st.floats(0.5, 1e4), min_size=3, max_size=3).map(np.array)
brackets = st.lists(st.floats(1e-3, 1.0), min_size=1, max_size=5, unique=True)


def reading(rate, exposure_s, *, noise=0.0, saturated=(False,) * 3, pixels=20):
    rate = np.asarray(rate, np.float64)
    return Reading(
        signal=rate * exposure_s + noise,
        exposure=np.full(3, exposure_s),
        pixels=np.full(3, pixels),
        saturated=np.array(saturated),
        read_variance=0.75 * READ,
        dark_variance=0.25 * READ,
        surround=np.zeros(3),
        stray=np.zeros(3),
        light=UP,
        view=UP,
        arms_rad=np.zeros(4),
        light_solid_angle=0.0,
        view_solid_angle=0.0,
    )


@given(rate=rates, exposures=brackets)
def test_readings_that_agree_keep_their_rate(rate, exposures):
    merged = merge([reading(rate, s) for s in exposures], GAIN)
    np.testing.assert_allclose(merged.value, rate, rtol=1e-12)
    assert not merged.clipped.any()


@given(rate=rates, exposures=brackets, seed=st.integers(0, 100), data=st.data())
def test_the_order_of_a_bracket_does_not_matter(rate, exposures, seed, data):
    noise = np.random.default_rng(seed).normal(size=(len(exposures), 3))
    bracket = [reading(rate, s, noise=n) for s, n in zip(exposures, noise, strict=True)]
    shuffled = data.draw(st.permutations(bracket))
    one, other = merge(bracket, GAIN), merge(shuffled, GAIN)
    np.testing.assert_allclose(one.value, other.value, rtol=1e-12)
    np.testing.assert_allclose(one.variance, other.variance, rtol=1e-12)


@given(rate=rates, exposures=brackets, scale=st.floats(1e-3, 1e3), seed=st.integers(0, 100))
def test_the_unit_of_exposure_scales_the_rate_and_nothing_else(rate, exposures, scale, seed):
    noise = np.random.default_rng(seed).normal(size=(len(exposures), 3))
    bracket = [reading(rate, s, noise=n) for s, n in zip(exposures, noise, strict=True)]
    scaled = [replace(one, exposure=scale * one.exposure) for one in bracket]
    one, other = merge(bracket, GAIN), merge(scaled, GAIN)
    np.testing.assert_allclose(other.value * scale, one.value, rtol=1e-9)
    np.testing.assert_allclose(other.variance * scale**2, one.variance, rtol=1e-9)


@given(rate=rates, exposures=brackets, scale=st.floats(1e-2, 1e2))
def test_the_unit_of_signal_scales_value_and_sigma_alike(rate, exposures, scale):
    bracket = [reading(rate, s) for s in exposures]
    scaled = [
        replace(
            one,
            signal=scale * one.signal,
            read_variance=scale**2 * one.read_variance,
            dark_variance=scale**2 * one.dark_variance,
        )
        for one in bracket
    ]
    one, other = merge(bracket, GAIN), merge(scaled, scale * GAIN)
    np.testing.assert_allclose(other.value / scale, one.value, rtol=1e-9)
    np.testing.assert_allclose(other.variance / scale**2, one.variance, rtol=1e-9)


@given(rate=rates, exposures=brackets, more=st.floats(1e-3, 1.0))
def test_another_exposure_never_makes_it_less_sure(rate, exposures, more):
    bracket = [reading(rate, s) for s in exposures]
    fewer, all_of_them = merge(bracket, GAIN), merge([*bracket, reading(rate, more)], GAIN)
    assert (all_of_them.variance < fewer.variance).all()


def test_one_exposure_has_the_photon_transfer_variance():
    merged = merge([reading([100.0, 200.0, 0.0], 0.5, pixels=10)], GAIN)
    expected = (GAIN * np.array([50.0, 100.0, 0.0]) + READ) / 10 / 0.5**2
    np.testing.assert_allclose(merged.variance, expected)


def test_saturated_exposures_do_not_count_channel_by_channel():
    bracket = [
        reading([100.0, 200.0, 300.0], 0.1),
        reading([55.0, 77.0, 300.0], 1.0, saturated=(True, True, False)),
    ]
    merged = merge(bracket, GAIN)
    np.testing.assert_allclose(merged.value, [100.0, 200.0, 300.0])
    assert not merged.clipped.any()


def test_saturated_everywhere_gives_the_bound_of_the_shortest():
    bracket = [
        reading([10.0, 20.0, 30.0], 1.0, saturated=(True, True, False)),
        reading([100.0, 200.0, 30.0], 0.1, saturated=(True, False, False)),
    ]
    merged = merge(bracket, GAIN)
    np.testing.assert_allclose(merged.value, [100.0, 200.0, 30.0])
    np.testing.assert_array_equal(merged.clipped, [True, False, False])


@pytest.mark.parametrize("electrons", [0.3, 3.0, 300.0])
def test_few_photons_are_not_underrated(electrons):
    # weights from the readings' own values would be some 10 % low at 3 electrons
    random = np.random.default_rng(1)
    values, variances = [], []
    for _ in range(3000):
        bracket = []
        for exposure_s in (0.5, 1.0):
            mean = np.full((20, 3), electrons * exposure_s)
            noisy = GAIN * random.poisson(mean) + np.sqrt(READ) * random.normal(size=mean.shape)
            bracket.append(replace(reading(0, exposure_s), signal=noisy.mean(axis=0)))
        merged = merge(bracket, GAIN)
        values.append(merged.value)
        variances.append(merged.variance)
    error = np.array(values) - GAIN * electrons
    sigma = np.sqrt(np.mean(variances))
    assert abs(error.mean()) < 4 * sigma / np.sqrt(error.size)
    assert error.std() == pytest.approx(sigma, rel=0.03)
