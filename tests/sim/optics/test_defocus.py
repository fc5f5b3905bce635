import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sim.optics.defocus import confusion_px, defocus, disc

FOCUS_MM = 2000.0
SHAPE = (24, 31)
images = arrays(np.float64, (*SHAPE, 3), elements=st.floats(0, 1e5))
widths = arrays(np.float64, SHAPE, elements=st.floats(0, 12))


SUBNORMAL = np.zeros((*SHAPE, 3))
SUBNORMAL[0, 0, 0] = 5e-324


@given(images, widths)
@example(SUBNORMAL, np.full(SHAPE, 2.0))
def test_no_light_is_lost_or_made(image, width):
    spread = defocus(image, width)
    before, after = image.sum(axis=(0, 1)), spread.sum(axis=(0, 1))
    # electrons: the smallest numbers that there are cannot be shared out
    np.testing.assert_allclose(after, before, rtol=1e-9, atol=1e-9)
    assert (spread > -1e-6).all()


@given(images)
def test_what_is_in_focus_stays_as_it_is(image):
    np.testing.assert_array_equal(defocus(image, np.zeros(SHAPE)), image)


@given(st.floats(0.01, 40))
def test_a_disc_is_as_wide_as_it_should_be(width):
    kernel = disc(width)
    assert kernel.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(kernel, kernel[::-1].T, atol=1e-12)
    across = np.arange(len(kernel)) - len(kernel) // 2
    variance = (kernel.sum(axis=0) * across**2).sum()
    # of a disc r^2 / 4; what falls between two pixels is shared by both, which adds up to 1 / 4
    assert width**2 / 16 * 0.9 <= variance <= width**2 / 16 * 1.05 + 0.25


def test_only_what_is_out_of_focus_is_spread():
    image = np.zeros((40, 40, 3))
    image[10, 20] = image[30, 20] = 1000.0
    width = np.zeros((40, 40))
    # the light crosses both ends of the band that is out of focus
    width[29:31, 19:21] = 6.0
    spread = defocus(image, width)[..., 1]
    assert spread[10, 20] == 1000.0
    assert spread[30, 20] == pytest.approx(1000.0 / (np.pi * 9), rel=0.1)
    assert spread[30].astype(bool).sum() == spread[20:, 20].astype(bool).sum() == 7
    assert spread.sum() == pytest.approx(2000.0)


@given(st.floats(-1000, 1000), st.floats(20, 400), st.floats(1.4, 32), st.floats(1e-3, 2e-2))
def test_the_circle_of_confusion_follows_the_thin_lens(nearer_mm, focal_mm, f_number, pixel_mm):
    # the cone of rays from the aperture to the image at v_z is cut by the sensor at v_s
    image_of = lambda z_mm: 1.0 / (1.0 / focal_mm - 1.0 / z_mm)  # noqa: E731
    sensor_mm, point_mm = image_of(FOCUS_MM), image_of(FOCUS_MM - nearer_mm)
    expected_mm = focal_mm / f_number * abs(point_mm - sensor_mm) / point_mm
    found = confusion_px(
        np.array(nearer_mm),
        distance_mm=FOCUS_MM,
        aperture_mm=focal_mm / f_number,
        focal_px=sensor_mm / pixel_mm,
    )
    assert found == pytest.approx(expected_mm / pixel_mm, rel=1e-6, abs=1e-9)
