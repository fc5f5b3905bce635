"""Dark current, the full well, and the chip that has them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.camera_imperfections import NONE, CameraImperfections
from sim.pixels.chip import Chip
from sim.pixels.dark_current import dark_rate
from sim.pixels.full_well import LARGEST_SHORTFALL, gathered
from sim.sensor import FULL_WELL_E

shortfalls = st.floats(0, LARGEST_SHORTFALL)
fills = st.floats(0, 20)


@given(st.floats(-40, 80), st.floats(0.01, 1e4), st.floats(1, 30))
def test_dark_current_doubles_with_every_few_degrees(temperature_c, at_25_c, doubling_c):
    cool = dark_rate(temperature_c, at_25_c, doubling_c)
    warm = dark_rate(temperature_c + doubling_c, at_25_c, doubling_c)
    assert warm == pytest.approx(2.0 * cool)
    assert dark_rate(25.0, at_25_c, doubling_c) == at_25_c


@given(shortfalls, st.floats(0, 0.1))
def test_low_signal_is_a_line(shortfall, fill):
    electrons = np.array([fill * FULL_WELL_E])
    np.testing.assert_allclose(gathered(electrons, shortfall), electrons, rtol=1e-5)


@given(shortfalls, fills, fills)
def test_more_electrons_never_read_as_less_and_a_full_well_is_full(shortfall, one, other):
    low, high = gathered(FULL_WELL_E * np.sort([one, other]), shortfall)
    assert low <= high
    full, flooded = gathered(FULL_WELL_E * np.array([1.0, 20.0]), shortfall)
    assert full == pytest.approx((1.0 - shortfall) * FULL_WELL_E)
    assert flooded >= FULL_WELL_E


def test_a_chip_without_imperfections_changes_no_bit():
    chip = Chip((30, 40), NONE, seed=3)
    electrons = np.random.default_rng(0).uniform(0, 2e5, (30, 40))
    np.testing.assert_array_equal(chip.mean_electrons(electrons, 2.0, warmth=1.0), electrons)
    np.testing.assert_array_equal(chip.read(electrons), electrons)


@given(st.floats(0.001, 300), st.floats(0, 1))
def test_dark_electrons_grow_with_time_and_warmth(exposure_s, warmth):
    sizes = CameraImperfections(camera_dark_e_per_s=8.0, camera_sensor_rise_c=12.0)
    mean = Chip((2, 2), sizes, seed=0).mean_electrons(np.zeros((2, 2)), exposure_s, warmth)
    expected = exposure_s * 8.0 * 2.0 ** ((23.0 + 12.0 * warmth - 25.0) / 6.0)
    np.testing.assert_allclose(mean, expected)
