"""Laws of the fits behind a calibration."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.calibrate.bad_pixels import find_bad
from gonio.calibrate.dark import DarkMaps, Stack, dark_maps
from gonio.calibrate.lighting import FULL_CURRENT_MA, setting_for
from gonio.calibrate.linearity import fit_linearity, slope
from gonio.calibrate.transfer import level_of
from gonio.calibration import Linearity
from gonio.materials import Lambertian
from sim.imperfections import IDEAL
from tests.calibrated_draws import DrawnTwin, drawn_calibration, imperfect_rig
from tests.draws import Errors

RANGE = 60_000.0


def bent(bend, reach=10.0):
    return Linearity(coefficients=bend, raw_range=RANGE, reach=reach, deviation=0.0, left=0.0)


bends = st.lists(st.floats(-0.05, 0.05), min_size=4, max_size=4).map(tuple)


@given(bend=bends, scale=st.floats(1e-3, 1e3))
def test_any_polynomial_bending_is_found_whatever_the_unit_of_dose(bend, scale):
    u = np.linspace(0.02, 0.97, 16)
    found, raw_per_dose = fit_linearity(scale * bent(bend).undo(RANGE * u), RANGE * u, RANGE)
    np.testing.assert_allclose(found.coefficients, bend, atol=1e-8)
    np.testing.assert_allclose(raw_per_dose, 1.0 / scale)
    assert found.left < 1e-9


@given(bend=bends, signal=st.floats(1.0, RANGE))
def test_the_slope_is_the_derivative(bend, signal):
    ahead, behind = (bent(bend).undo(np.array(signal + step)) for step in (0.5, -0.5))
    np.testing.assert_allclose(slope(bent(bend), np.array(signal)), ahead - behind, atol=1e-6)


@given(bend=bends, beyond=st.floats(1.0, 2.0))
def test_beyond_its_reach_nothing_is_extrapolated(bend, beyond):
    known = bent(bend, reach=0.5)
    ends = known.bending(np.array(0.5 * RANGE))
    np.testing.assert_allclose(known.bending(np.array(0.5 * beyond * RANGE)), ends)


@given(
    offset=st.integers(0, 500),
    rate=st.integers(0, 200),
    exposures=st.lists(st.integers(1, 50), min_size=2, max_size=5, unique=True),
)
def test_dark_frames_on_a_line_give_it_back(offset, rate, exposures):
    stacks = {}
    for exposure_s in exposures:
        stacks[float(exposure_s)] = stack = Stack()
        for _ in range(2):
            stack.add(np.full((2, 2), offset + rate * exposure_s, np.uint16))
    maps = dark_maps(stacks)
    np.testing.assert_allclose(maps.offset, offset, atol=1e-8)
    np.testing.assert_allclose(maps.rate, rate, atol=1e-9)
    np.testing.assert_allclose(maps.variance, 0.0)


@given(seed=st.integers(0, 1000))
def test_a_stack_has_numpy_s_mean_and_variance(seed):
    frames = np.random.default_rng(seed).integers(0, 65535, (5, 3, 4)).astype(np.uint16)
    stack = Stack()
    for frame in frames:
        stack.add(frame)
    np.testing.assert_allclose(stack.mean, frames.mean(axis=0))
    np.testing.assert_allclose(stack.variance, frames.var(axis=0, ddof=1))


@given(seed=st.integers(0, 1000))
def test_bad_pixels_are_found_each_once_and_good_ones_are_not(seed):
    random = np.random.default_rng(seed)
    offset, rate = random.normal(1000, 5, (50, 50)), random.normal(1, 0.5, (50, 50))
    variance, response = random.chisquare(28, (50, 50)) / 28, random.normal(1, 0.02, (50, 50))
    offset[0, 0] += 100
    rate[1, 1] = rate[2, 2] = 50
    variance[2, 2] = variance[3, 3] = 20
    response[4, 4] = 0.5
    bad, counts = find_bad(DarkMaps(offset, rate, variance, 1.0), response, np.ones((50, 50)))
    np.testing.assert_array_equal(np.nonzero(bad), [range(5), range(5)])
    assert (counts.hot, counts.noisy, counts.offset, counts.response) == (2, 1, 1, 1)


@given(level=st.floats(0.01, 1.2), per_s=st.floats(0.01, 1e3))
def test_a_setting_reaches_its_level_within_the_lamps_current(level, per_s):
    exposures = (0.002, 0.02, 0.2, 2.0)
    exposure_s, current_mA = setting_for(level, per_s, exposures)
    assert exposure_s in exposures
    assert 0 < current_mA <= FULL_CURRENT_MA
    reached = per_s * exposure_s * current_mA / FULL_CURRENT_MA
    if per_s * exposures[-1] >= level:
        np.testing.assert_allclose(reached, level)
    else:
        assert reached < level


@pytest.mark.parametrize("unit", [1.0, 1e-12], ids=["raw units", "1/mm2"])
def test_the_linearity_errs_as_its_errors_say(unit):
    random, u = np.random.default_rng(0), np.linspace(0.02, 0.97, 16)
    true = bent((0.02, -0.03, 0.01, 0.04))
    scores = []
    for _ in range(300):
        dose = unit * true.undo(RANGE * u) * (1.0 + 0.001 * random.normal(size=16))
        found, _ = fit_linearity(dose, RANGE * u, RANGE)
        off = found.bending(np.array(0.9 * RANGE)) - true.bending(np.array(0.9 * RANGE))
        scores.append(off / np.linalg.norm(np.array(found.errors) @ 0.9 ** np.arange(1, 5)))
    # a t distribution of eleven degrees of freedom
    assert 0.95 < np.std(scores) < 1.25


def test_light_that_changes_its_color_bends_nothing():
    random, u = np.random.default_rng(1), np.linspace(0.02, 0.97, 16)
    true, color = bent((0.02, -0.03, 0.01, 0.04)), random.uniform(-0.05, 0.0, 16)
    # a green filter sees a fifth of the red that lamps lose
    dose = true.undo(RANGE * u) / (1.0 + 0.2 * color)
    at = np.array(0.6 * RANGE)
    plain, told = (fit_linearity(dose, RANGE * u, RANGE, each)[0] for each in (None, color))
    assert abs(plain.bending(at) - true.bending(at)) > 5e-4
    assert abs(told.bending(at) - true.bending(at)) < 1e-4


def test_levels_whose_photons_scatter_more_count_less():
    random, u = np.random.default_rng(2), np.linspace(0.02, 0.97, 16)
    true, noise, at = bent((0.0, 0.0, 0.0, 0.03)), 2e-4 / u, np.array(0.9 * RANGE)
    off = []
    for _ in range(100):
        dose = true.undo(RANGE * u) * (1.0 + noise * random.normal(size=16))
        found = [fit_linearity(dose, RANGE * u, RANGE, noise=each)[0] for each in (noise, None)]
        off.append([each.bending(at) - true.bending(at) for each in found])
    weighted, even = np.std(off, axis=0)
    assert weighted < 0.7 * even


def test_a_level_s_variance_is_that_of_its_photons_however_few_the_pixels():
    random = np.random.default_rng(3)
    found = [
        level_of(random.normal(1e4, 100.0, (4, 8)), np.ones(4), saturated=False).variance
        for _ in range(2000)
    ]
    # each is of 21 free values, so that all of them tell it to 0.7 %
    np.testing.assert_allclose(np.mean(found), 1e4, rtol=0.03)


def test_a_lamp_is_known_no_better_than_its_monitor():
    random = np.random.default_rng(6)
    rig = imperfect_rig("none")
    told = rig.uncertainty.model_copy(update={"flux_monitor": 0.01})
    rig = rig.model_copy(update={"uncertainty": told})
    twin = DrawnTwin(rig, Lambertian(0.5), IDEAL, Errors.draw(rig, random), random)
    lamps = drawn_calibration(twin).document.lamps
    off, sigma = np.array([(lamp.strength - 1.0, lamp.sigma) for lamp in lamps]).T
    # one frame of each
    np.testing.assert_allclose(sigma, 0.01, rtol=0.1)
    assert 0.5 < np.sqrt(np.mean((off / sigma) ** 2)) < 1.6
