import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.camera_imperfections import CameraImperfections
from sim.pixels.fixed_pattern import FixedPattern

SHAPE = (60, 50)
seeds = st.integers(0, 2**32)


def pattern(seed=0, **sizes):
    return FixedPattern.of(SHAPE, CameraImperfections(**sizes), seed)


@given(seeds, st.floats(0, 0.1))
def test_prnu_keeps_the_mean(seed, size):
    response = np.broadcast_to(pattern(seed, camera_prnu=size).response, SHAPE)
    assert response.mean() == pytest.approx(1.0, abs=1e-12)
    assert response.std() == pytest.approx(size, rel=0.1)


@given(seeds, st.floats(0.01, 100))
def test_offsets_keep_the_mean_and_columns_are_one_value_each(seed, size):
    pixel = pattern(seed, camera_dsnu_e=size).offset_e
    column = np.broadcast_to(pattern(seed, camera_column_e=size).offset_e, SHAPE)
    for offset in (pixel, column):
        assert offset.mean() == pytest.approx(0.0, abs=1e-9)
    assert pixel.std() == pytest.approx(size, rel=0.1)
    assert (column == column[0]).all()
    assert column[0].std() == pytest.approx(size, rel=0.5)


@given(seeds)
def test_few_pixels_are_hot_by_very_much(seed):
    dark = pattern(seed, camera_hot_share=0.05, camera_hot_times=80.0).dark
    hot = dark > 1.0
    assert hot.mean() == pytest.approx(0.05, abs=0.025)
    assert dark[hot].mean() == pytest.approx(81.0, rel=0.6)
    assert (dark >= 1.0).all()


def test_a_sensor_is_the_one_of_its_seed_and_each_kind_is_drawn_for_itself():
    one, again, other = (pattern(seed, camera_prnu=0.01).response for seed in (1, 1, 2))
    np.testing.assert_array_equal(one, again)
    assert abs(np.corrcoef(one.ravel(), other.ravel())[0, 1]) < 0.1
    both = pattern(1, camera_prnu=0.01, camera_dsnu_e=2.0)
    np.testing.assert_array_equal(both.response, one)
    assert abs(np.corrcoef(one.ravel(), both.offset_e.ravel())[0, 1]) < 0.1
