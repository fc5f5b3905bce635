import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from gonio.directions import (
    RINGS_81,
    from_degrees,
    from_half_difference,
    from_spherical,
    half_vector,
    normalize,
    paper_angles_deg,
    paper_directions,
    to_degrees,
    to_half_difference,
    to_spherical,
)
from gonio.errors import BadInputError

THETA = st.floats(0.0, math.pi / 2)
PHI = st.floats(0.0, 2 * math.pi, exclude_max=True)
DIRECTION = st.builds(from_spherical, THETA, PHI)
POLE = np.array([0.0, 0.0, 1.0])
EAST = np.array([1.0, 0.0, 0.0])


def turn_difference(a, b):
    """Return the difference of two azimuths in [-pi, pi)."""
    return (np.asarray(a) - b + math.pi) % (2 * math.pi) - math.pi


@given(theta=st.floats(0.0, math.pi), phi=PHI)
def test_spherical_round_trip(theta, phi):
    direction = from_spherical(theta, phi)
    assert np.linalg.norm(direction) == pytest.approx(1.0, abs=1e-15)
    back_theta, back_phi = to_spherical(direction)
    assert back_theta == pytest.approx(theta, abs=1e-14)
    # near a pole the azimuth is worth as little as the circle is short
    assert math.sin(theta) * turn_difference(back_phi, phi) == pytest.approx(0.0, abs=1e-14)
    assert 0.0 <= back_phi < 2 * math.pi


@pytest.mark.parametrize("theta", [1e-300, 1e-160, 1e-12, 1e-8, math.pi / 2 - 1e-12])
def test_small_angles_keep_their_precision(theta):
    assert to_spherical(from_spherical(theta, 1.0))[0] == pytest.approx(theta, rel=1e-12)


@pytest.mark.parametrize("pole", [(0.0, 0.0, 1.0), (-0.0, 0.0, 1.0), (0.0, -0.0, -1.0)])
def test_azimuth_at_the_poles_is_zero(pole):
    theta, phi = to_spherical(pole)
    assert phi == 0.0
    assert theta == (0.0 if pole[2] > 0 else math.pi)


def test_an_azimuth_just_below_zero_does_not_become_a_full_turn():
    _, phi = to_spherical([1.0, -1e-30, 0.0])
    assert phi == 0.0


@given(theta=st.floats(0.0, 90.0), phi=st.floats(0.0, 360.0, exclude_max=True))
def test_degrees_round_trip(theta, phi):
    back_theta, back_phi = to_degrees(from_degrees(theta, phi))
    assert back_theta == pytest.approx(theta, abs=1e-12)
    turn = turn_difference(np.radians(back_phi), np.radians(phi))
    assert math.sin(math.radians(theta)) * turn == pytest.approx(0.0, abs=1e-13)


REFUSED = [
    # name, theta, phi, what the line says
    ("transmission", [10.0, 90.001], 0.0, "transmission"),
    ("below zero", -0.1, 0.0, "negative"),
    ("theta not a number", math.nan, 0.0, "theta is not finite"),
    ("theta infinite", math.inf, 0.0, "theta is not finite"),
    ("phi not a number", 10.0, math.nan, "phi is not finite"),
]


@pytest.mark.parametrize(
    ("theta", "phi", "says"), [c[1:] for c in REFUSED], ids=[c[0] for c in REFUSED]
)
def test_angles_that_reflection_does_not_have(theta, phi, says):
    with pytest.raises(BadInputError, match=says):
        from_degrees(theta, phi)


def test_shapes_are_kept():
    assert from_spherical(np.zeros((4, 1)), np.zeros(5)).shape == (4, 5, 3)
    assert to_spherical(np.ones((2, 3, 3)))[0].shape == (2, 3)


# squares of lesser numbers would underflow
COMPONENT = st.just(0.0) | st.floats(1e-100, 1e100) | st.floats(-1e100, -1e-100)


@given(st.lists(COMPONENT, min_size=3, max_size=3))
def test_normalize_gives_unit_length_or_null(vector):
    length = np.linalg.norm(normalize(vector))
    assert length == (pytest.approx(1.0) if any(vector) else 0.0)


@given(light=DIRECTION, view=DIRECTION)
def test_half_vector_lies_midway(light, view):
    half = half_vector(light, view)
    assert np.linalg.norm(half) == pytest.approx(1.0)
    # both are unit vectors, so both make the same angle with their half vector
    if np.linalg.norm(light + view) > 1e-6:
        assert half @ light == pytest.approx(half @ view, abs=1e-9)


@pytest.mark.parametrize("azimuth", [0.0, 1.0, 4.0])
def test_half_vector_of_opposite_directions_is_the_normal(azimuth):
    light = from_spherical(math.pi / 2, azimuth)
    np.testing.assert_array_equal(half_vector(light, -light), POLE)


@given(light=DIRECTION, view=DIRECTION)
@example(light=EAST, view=-EAST)
@example(light=POLE, view=POLE)
@example(light=EAST, view=EAST)
def test_half_difference_round_trip(light, view):
    back_light, back_view = from_half_difference(*to_half_difference(light, view))
    np.testing.assert_allclose(back_light, light, atol=1e-11)
    np.testing.assert_allclose(back_view, view, atol=1e-11)


@given(light=DIRECTION, view=DIRECTION)
@example(light=EAST, view=-EAST)
@example(light=POLE, view=POLE)
@example(light=EAST, view=EAST)
def test_exchange_turns_phi_d_by_pi_and_nothing_else(light, view):
    theta_h, phi_h, theta_d, phi_d = to_half_difference(light, view)
    other = to_half_difference(view, light)
    assert other[0] == pytest.approx(theta_h, abs=1e-12)
    assert turn_difference(other[1], phi_h) == pytest.approx(0.0, abs=1e-9)
    assert other[2] == pytest.approx(theta_d, abs=1e-9)
    turned = turn_difference(other[3], phi_d + math.pi)
    assert math.sin(theta_d) * turned == pytest.approx(0.0, abs=1e-9)


@given(theta=st.floats(0.01, math.pi / 2 - 0.01), phi=PHI)
def test_mirror_pairs_have_the_normal_as_half_vector(theta, phi):
    light, view = from_spherical(theta, phi), from_spherical(theta, phi + math.pi)
    theta_h, _, theta_d, _ = to_half_difference(light, view)
    assert theta_h == pytest.approx(0.0, abs=1e-12)
    assert theta_d == pytest.approx(theta)


@given(theta=THETA, phi=PHI)
def test_coinciding_directions_have_no_difference(theta, phi):
    light = from_spherical(theta, phi)
    _, _, theta_d, phi_d = to_half_difference(light, light)
    assert (theta_d, phi_d) == (0.0, 0.0)


def test_where_the_half_vector_is_the_normal_phi_d_is_the_lights_azimuth():
    light, view = np.array([0.6, 0.0, 0.8]), np.array([-0.6, 0.0, 0.8])
    for a, b, azimuth in ((light, view, 0.0), (view, light, math.pi)):
        _, phi_h, _, phi_d = to_half_difference(a, b)
        assert phi_h == 0.0
        assert phi_d == pytest.approx(azimuth)


@given(theta=st.floats(0.01, 1.5), phi=PHI)
def test_rounding_does_not_choose_phi_h_of_mirror_pairs(theta, phi):
    light, view = from_spherical(theta, phi), from_spherical(theta, phi + math.pi)
    theta_h, phi_h, theta_d, phi_d = to_half_difference(light, view)
    assert phi_h == 0.0
    assert theta_h == pytest.approx(0.0, abs=1e-12)
    assert theta_d == pytest.approx(theta)
    assert turn_difference(phi_d, phi) == pytest.approx(0.0, abs=1e-9)


@given(light=DIRECTION, view=DIRECTION, turn=st.floats(0.1, 6.0))
def test_turning_the_sample_turns_phi_h_alone(light, view, turn):
    """An isotropic material sees theta_h, theta_d and phi_d only."""
    cos, sin = math.cos(turn), math.sin(turn)
    about_z = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    theta_h, _, theta_d, phi_d = to_half_difference(light, view)
    turned = to_half_difference(about_z @ light, about_z @ view)
    assert turned[0] == pytest.approx(theta_h, abs=1e-9)
    assert turned[2] == pytest.approx(theta_d, abs=1e-7)
    if theta_h > 1e-6 and theta_d > 1e-6:
        assert turn_difference(turned[3], phi_d) == pytest.approx(0.0, abs=1e-6)


def test_the_81_directions():
    theta, phi = paper_angles_deg()
    assert len(theta) == 81
    assert [(t, int((theta == t).sum())) for t in np.unique(theta)] == list(RINGS_81)
    for ring, count in RINGS_81:
        np.testing.assert_allclose(phi[theta == ring], np.arange(count) * 360 / count)
    np.testing.assert_array_equal(paper_directions()[0], POLE)
