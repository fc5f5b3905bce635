"""What lamps and sensor were used for shows: the sensor's heat, and the lamps' spectral mix."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.spectral_mix import spectral_mix
from sim.warmth import SensorHeat

times = st.lists(st.floats(0, 1000), min_size=1, max_size=6)


@given(times)
def test_a_sensor_is_never_cooler_than_rested_nor_warmer_than_in_use(steps_s):
    heat, now = SensorHeat(0.0), 0.0
    for number, step_s in enumerate(steps_s):
        heat.use(now, in_use=number % 2 == 0)
        before, after = heat.warmth(now), heat.warmth(now + step_s)
        assert 0.0 <= after <= 1.0
        assert (after >= before) if number % 2 == 0 else (after <= before)
        now += step_s


@given(st.floats(0, 2000), st.floats(0, 1))
def test_to_look_in_between_changes_nothing(duration_s, part):
    once, twice = SensorHeat(0.0), SensorHeat(0.0)
    once.use(0.0, in_use=True)
    twice.use(0.0, in_use=True)
    twice.use(part * duration_s, in_use=True)
    expected = 1.0 - math.exp(-duration_s / 300.0)
    assert once.warmth(duration_s) == pytest.approx(expected, abs=1e-12)
    assert twice.warmth(duration_s) == pytest.approx(expected, abs=1e-12)


@given(st.floats(25, 90), st.floats(-0.005, 0.005), st.floats(-0.005, 0.005))
def test_the_mix_is_even_at_25_deg_c_and_moves_by_so_much_for_each_degree(junction_c, red, blue):
    assert spectral_mix(25.0, red, blue).tolist() == [1.0, 1.0, 1.0]
    now, warmer = spectral_mix(junction_c, red, blue), spectral_mix(junction_c + 1.0, red, blue)
    assert warmer - now == pytest.approx([red, 0.0, blue], abs=1e-12)
