"""Color spaces: laws that hold for every color, and numbers that others publish."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gonio.color import (
    ACES_WHITE,
    CAMERA,
    D50,
    D65,
    SPACES,
    adaptation,
    lab_from_xyz,
    srgb_from,
    xyz_from_lab,
)

COLORS = arrays(np.float64, (5, 3), elements=st.floats(-1.0, 10.0))
NAMES = st.sampled_from(sorted(SPACES))
WHITES = st.sampled_from([D50, D65, ACES_WHITE, np.ones(3)])


@given(COLORS, st.lists(NAMES, min_size=1, max_size=4))
def test_a_color_comes_back_from_any_journey_through_spaces(colors, journey):
    there, at = colors, "linear-srgb"
    for name in [*journey, "linear-srgb"]:
        there = there @ (SPACES[name].from_srgb @ np.linalg.inv(SPACES[at].from_srgb)).T
        at = name
    np.testing.assert_allclose(there, colors, rtol=0, atol=1e-11)


def test_white_is_the_white_of_each_space():
    for name, white in {"linear-srgb": 1.0, "acescg": 1.0, "xyz": D65}.items():
        np.testing.assert_allclose(SPACES[name].white, white * np.ones(3), rtol=1e-6)


@given(WHITES, WHITES)
def test_adaptation_takes_white_to_white_and_back(white, to):
    np.testing.assert_allclose(adaptation(white, to) @ white, to, rtol=1e-12)
    both = adaptation(to, white) @ adaptation(white, to)
    np.testing.assert_allclose(both, np.eye(3), atol=1e-12)


@given(arrays(np.float64, (5, 3), elements=st.floats(0.0, 2.0)), WHITES)
def test_cielab_comes_back(xyz, white):
    np.testing.assert_allclose(xyz_from_lab(lab_from_xyz(xyz, white), white), xyz, atol=1e-12)


def test_acescg_is_as_published():
    """Bradford's matrix from linear sRGB, as colour-science 0.4.7 gives it from rounded whites."""
    published = [
        [0.61313242, 0.33953802, 0.0474167],
        [0.07012438, 0.91639401, 0.01345152],
        [0.02058766, 0.10957457, 0.8697854],
    ]
    np.testing.assert_allclose(SPACES["acescg"].from_srgb, published, atol=1e-4)


def test_adaptation_from_d65_to_d50_is_as_published():
    """Lindbloom's table of Bradford matrices."""
    published = [
        [1.0478112, 0.0228866, -0.0501270],
        [0.0295424, 0.9904844, -0.0170491],
        [-0.0092345, 0.0150436, 0.7521316],
    ]
    np.testing.assert_allclose(adaptation(D65, D50), published, atol=2e-5)


@pytest.mark.parametrize("name", SPACES)
def test_a_space_is_shown_as_srgb(name):
    space = SPACES[name]
    np.testing.assert_allclose(srgb_from(space.name) @ space.from_srgb, np.eye(3), atol=1e-12)


def test_what_is_of_no_known_look_is_not_shown():
    assert srgb_from(CAMERA) is None
