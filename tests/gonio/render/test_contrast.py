"""Exposure, difference and its scale."""

import numpy as np
import pytest

from gonio.render import Picture
from gonio.render.contrast import Contrast, contrast, developed, exposure, scale_of

COVER = np.pad(np.ones((4, 4)), 2)


def grey(value):
    return Picture(value * COVER[..., None] * np.ones(3), COVER)


def test_a_meter_makes_the_mean_middle_grey_whatever_the_light():
    for light in (1e-3, 1.0, 1e3):
        assert light * exposure([grey(light)]) == pytest.approx(0.18)
    assert exposure([grey(1.0)], 1.0) == pytest.approx(0.36)
    assert exposure([grey(0.0)]) == 1.0


def test_differences_are_those_of_the_pictures_and_of_the_shape_alone():
    one, other = grey(0.2), grey(0.25)
    found = contrast(one, other, 1.0)
    steps = developed(other, 1.0).max() - developed(one, 1.0).max()
    assert found.mean == steps
    assert found.psnr_db == pytest.approx(20 * np.log10(255 / steps))
    assert np.isnan(found.steps[0, 0])
    assert contrast(one, one, 1.0).psnr_db == np.inf


def test_the_scale_is_round_and_fits_the_middle_one():
    assert scale_of([Contrast(np.full((2, 2), each), each, 0.0) for each in (0.1, 3, 200)]) == 5
