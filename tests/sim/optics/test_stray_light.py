import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sim.optics.stray_light import halo, veiling_glare

images = arrays(np.float64, (20, 27, 3), elements=st.floats(0, 1e5))
shares = st.floats(0, 1)


@given(images, shares)
def test_veiling_glare_adds_its_share_of_the_mean_everywhere(image, share):
    veiled = veiling_glare(image, share)
    mean = image.mean(axis=(0, 1))
    np.testing.assert_allclose(veiled.mean(axis=(0, 1)), mean, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(veiled - (1 - share) * image - share * mean, 0, atol=1e-8)


@given(images, shares, st.floats(0, 30))
def test_a_halo_keeps_the_light_in_the_frame(image, share, sigma_px):
    spread = halo(image, share, sigma_px)
    np.testing.assert_allclose(
        spread.sum(axis=(0, 1)), image.sum(axis=(0, 1)), rtol=1e-9, atol=1e-6
    )
    assert spread.min() > -1e-6


@given(st.floats(1, 12))
def test_a_halo_is_as_wide_as_it_should_be(sigma_px):
    image = np.zeros((161, 161, 3))
    image[80, 80] = 1.0
    spread = halo(image, 0.25, sigma_px)[..., 0]
    spread[80, 80] -= 0.75
    assert spread.sum() == pytest.approx(0.25)
    across = np.arange(161) - 80
    deviation = np.sqrt((spread.sum(axis=0) * across**2).sum() / spread.sum())
    # boxes are of whole, odd pixels
    assert deviation == pytest.approx(sigma_px, abs=0.6)
