import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from gonio.directions import from_degrees, from_spherical, paper_directions
from gonio.errors import BadInputError
from nnbrdf.encoding import ENCODINGS, INPUTS, encoding_named

NAMES = list(ENCODINGS)
RANGE = {
    "xyz": (-1, 1),
    "spherical": (0, 1),
    "sincos": (-1, 1),
    "rusinkiewicz": (0, 1),
    "half-difference": (-1, 1),
    "paper-literal": (-1, 1),
}
PERIODIC = ["xyz", "sincos", "half-difference"]
JUMPS_AT_360 = ["spherical", "paper-literal"]

THETA = st.floats(0.0, math.pi / 2)
PHI = st.floats(0.0, 2 * math.pi, exclude_max=True)
DIRECTION = st.builds(from_spherical, THETA, PHI)
POLE = np.array([0.0, 0.0, 1.0])
EAST = np.array([1.0, 0.0, 0.0])


def encode(name, light, view):
    return encoding_named(name)(np.atleast_2d(light), np.atleast_2d(view))[0]


def grid_pairs():
    grid = paper_directions()
    return np.repeat(grid, 81, axis=0), np.tile(grid, (81, 1))


def turned(direction, angle):
    cos, sin = math.cos(angle), math.sin(angle)
    return direction @ np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]]).T


def test_the_six_names():
    assert set(NAMES) == set(RANGE) == set(INPUTS)


def test_an_unknown_name_lists_the_known():
    with pytest.raises(BadInputError, match="encoding 'polar' is not known; use xyz, spherical, s"):
        encoding_named("polar")


LIGHT, VIEW = from_degrees(45, 90), from_degrees(60, 180)
LITERAL = [
    math.sin(1 / 3) * math.cos(1.0), math.sin(1 / 3) * math.sin(1.0), math.cos(1 / 3),
    math.sin(0.25) * math.cos(0.5), math.sin(0.25) * math.sin(0.5), math.cos(0.25),
]  # fmt: skip
KNOWN = {
    "xyz": [*VIEW, *LIGHT],
    "spherical": [2 / 3, 1 / 2, 1 / 2, 1 / 4],
    "sincos": [math.sqrt(3) / 2, 1 / 2, 0, -1, math.sqrt(1 / 2), math.sqrt(1 / 2), 1, 0],
    "paper-literal": LITERAL,
}


@pytest.mark.parametrize("name", KNOWN)
def test_known_inputs(name):
    np.testing.assert_allclose(encode(name, LIGHT, VIEW), KNOWN[name], atol=1e-12)


def test_known_half_and_difference():
    light, view = from_degrees(60, 0), from_degrees(0, 0)
    half = [0.5, 0, math.sqrt(3) / 2]
    # seen from the half vector both are 30 deg away, the light further along +x
    np.testing.assert_allclose(encode("half-difference", light, view), [*half, *half], atol=1e-12)
    np.testing.assert_allclose(
        encode("rusinkiewicz", view, light), [1 / 3, 0, 1 / 3, 1 / 2], atol=1e-12
    )


@pytest.mark.parametrize("name", NAMES)
@given(light=DIRECTION, view=DIRECTION, stretch=st.floats(1 - 1e-15, 1 + 1e-15))
@example(light=POLE, view=EAST, stretch=1.0)
@example(light=EAST, view=POLE, stretch=1.0)
@example(light=POLE, view=POLE, stretch=1 + 1e-15)
@example(light=EAST, view=EAST, stretch=1 + 1e-15)
@example(light=EAST, view=-EAST, stretch=1.0)
@example(light=np.array([1e-320, 0, 1]), view=np.array([0, -1e-320, 1]), stretch=1.0)
@example(light=np.array([0.6, -1e-300, 0.8]), view=np.array([-0.6, 1e-17, 0.8]), stretch=1.0)
def test_finite_and_within_the_stated_range(name, light, view, stretch):
    inputs = encode(name, stretch * light, view)
    least, most = RANGE[name]
    assert inputs.shape == (INPUTS[name],)
    assert np.isfinite(inputs).all()
    assert inputs.min() >= least - 1e-12
    assert inputs.max() <= most + 1e-12


def across_360(name, theta):
    """Return how far inputs move where the light passes phi = 360 deg by a part in 1e9."""
    view = from_degrees(30, 90)
    before, after = from_degrees(theta, 360 - 1e-7), from_degrees(theta, 1e-7)
    return np.linalg.norm(encode(name, after, view) - encode(name, before, view))


@pytest.mark.parametrize("name", PERIODIC)
@given(theta=st.floats(1, 90))
def test_periodic_in_azimuth(name, theta):
    assert across_360(name, theta) < 1e-6


@pytest.mark.parametrize("name", JUMPS_AT_360)
@given(theta=st.floats(1, 90))
def test_jumps_where_the_azimuth_passes_360_deg(name, theta):
    expected = {"spherical": 1.0, "paper-literal": 2 * math.sin(1) * math.sin(theta / 180)}
    assert across_360(name, theta) == pytest.approx(expected[name], abs=1e-6)


def test_the_printed_formula_jumps_by_20_steps_of_the_outer_ring():
    azimuths = from_degrees(75.0, np.arange(24) * 15.0)
    inputs = ENCODINGS["paper-literal"](azimuths, np.broadcast_to(POLE, (24, 3)))
    steps = np.linalg.norm(np.diff(inputs, axis=0), axis=1)
    assert steps == pytest.approx(0.0337, abs=1e-4)
    assert across_360("paper-literal", 75.0) == pytest.approx(0.681, abs=1e-3)


def test_rusinkiewicz_jumps_where_phi_h_passes_360_deg():
    for side in (1e-7, -1e-7):
        light = from_degrees(50, side)
        phi_h = encode("rusinkiewicz", light, from_degrees(20, side))[1]
        assert phi_h == pytest.approx(0.0 if side > 0 else 1.0, abs=1e-6)


LEAST_DISTANCE = {
    "xyz": 0.2456,
    "spherical": 0.0417,
    "sincos": 0.2611,
    "rusinkiewicz": 0.0370,
    "half-difference": 0.0594,
    "paper-literal": 0.0275,
}


@pytest.mark.parametrize("name", NAMES)
def test_no_two_pairs_of_the_grid_look_alike(name):
    inputs = ENCODINGS[name](*grid_pairs())
    nearest, _ = cKDTree(inputs).query(inputs, k=2)
    assert nearest[:, 1].min() == pytest.approx(LEAST_DISTANCE[name], abs=1e-4)


@pytest.mark.parametrize("name", ["spherical", "rusinkiewicz", "paper-literal"])
def test_rounding_does_not_move_pairs_of_the_grid_across_the_jump(name):
    light, view = grid_pairs()
    noise = np.random.default_rng(0).normal(0, 1e-16, (2, *light.shape))
    difference = ENCODINGS[name](light, view) - ENCODINGS[name](light + noise[0], view + noise[1])
    # a rounded pole has a random azimuth: that is a real discontinuity, and left out
    away = (light[:, 2] < 1 - 1e-9) & (view[:, 2] < 1 - 1e-9) & (light != view).any(axis=1)
    assert np.abs(difference[away]).max() < 1e-9


@given(light=DIRECTION, view=DIRECTION, turn=st.floats(0.1, 6.0))
def test_turning_the_sample_turns_the_vectors(light, view, turn):
    pair = turned(light, turn), turned(view, turn)
    before, after = encode("xyz", light, view), encode("xyz", *pair)
    np.testing.assert_allclose(after[:3], turned(before[:3], turn), atol=1e-12)
    np.testing.assert_allclose(after[3:], turned(before[3:], turn), atol=1e-12)
    half = encode("half-difference", light, view)[:3]
    np.testing.assert_allclose(encode("half-difference", *pair)[:3], turned(half, turn), atol=1e-9)


AWAY = st.builds(from_spherical, st.floats(0.2, 1.5), PHI)


@given(light=AWAY, view=AWAY, turn=st.floats(0.1, 6.0))
def test_turning_the_sample_adds_to_azimuths_alone(light, view, turn):
    pair = turned(light, turn), turned(view, turn)
    for name, azimuths in (("spherical", [1, 3]), ("rusinkiewicz", [1])):
        if name == "rusinkiewicz" and np.linalg.norm((light + view)[:2]) < 1e-3:
            continue
        if name == "rusinkiewicz" and np.linalg.norm(light - view) < 1e-3:
            continue
        moved = encode(name, *pair) - encode(name, light, view)
        moved[azimuths] -= turn / (2 * math.pi)
        whole_turns = np.round(moved)
        np.testing.assert_allclose(moved, whole_turns, atol=1e-6)
        assert not whole_turns[[0, 2]].any()


@given(light=AWAY, view=AWAY)
def test_exchanging_light_and_view_turns_the_difference_half_way(light, view):
    if np.linalg.norm(light - view) < 1e-6:
        return
    there, back = (encode("half-difference", *pair) for pair in ((light, view), (view, light)))
    np.testing.assert_allclose(back, there * [1, 1, 1, -1, -1, 1], atol=1e-9)
