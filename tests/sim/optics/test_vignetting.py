import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.rig import default_rig
from sim.optics.vignetting import natural_falloff, optical_falloff

SPEC = default_rig().camera


@st.composite
def cameras(draw):
    """Cameras of any size whose centre is a pixel of theirs."""
    width, height = draw(st.integers(2, 40)), draw(st.integers(2, 40))
    centre = (draw(st.integers(0, width - 1)), draw(st.integers(0, height - 1)))
    focal_px = draw(st.floats(100, 5000))
    return SPEC.model_copy(
        update={"width": width, "height": height, "focal_px": focal_px, "centre_px": centre}
    )


@given(cameras(), st.floats(0, 1))
def test_both_are_1_at_the_centre_and_fall_outwards(spec, loss):
    x, y = spec.centre_px
    away = np.hypot(np.arange(spec.width) - x, np.arange(spec.height)[:, None] - y)
    for falloff in (natural_falloff(spec), optical_falloff(spec, loss)):
        assert falloff[y, x] == 1.0
        along = falloff.ravel()[np.argsort(away, axis=None)]
        assert (np.diff(along) <= 1e-12).all()
    assert optical_falloff(spec, loss).min() == pytest.approx(1.0 - loss)


@given(st.floats(0, 80))
def test_the_natural_one_is_the_fourth_power_of_the_cosine(angle_deg):
    column = round(100 * np.tan(np.radians(angle_deg)))
    spec = SPEC.model_copy(
        update={"width": 1000, "height": 2, "focal_px": 100.0, "centre_px": (0.0, 0.0)}
    )
    cosine = np.cos(np.arctan2(column, 100))
    assert natural_falloff(spec)[0, column] == pytest.approx(cosine**4, rel=1e-9)
