"""White balance under other light than the matrix was made for: two models, and their distance."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gonio.color import SPACES
from gonio.reduce.balance import MODEL_SHARE, PRIMARIES, balance
from gonio.reduce.color import Coloring
from sim.sensor import CAMERA_FROM_SRGB

KNOWN = np.full(3, 0.99 / np.pi)
lights = arrays(np.float64, 3, elements=st.floats(0.5, 2.0))
colors = arrays(np.float64, (4, 3), elements=st.floats(0.01, 0.3))
cameras = arrays(np.float64, (3, 3), elements=st.floats(0.0, 0.3)).map(
    lambda part: part + np.eye(3)
)
spaces = st.sampled_from(sorted(SPACES))


def coloring(camera, space="linear-srgb", *, lit=True):
    """How a camera whose unbalanced channels are `camera` @ linear sRGB is known."""
    neutral = camera.sum(axis=1)
    from_srgb = SPACES[space].from_srgb
    to_camera = camera / neutral[:, None] @ np.linalg.inv(from_srgb)
    return Coloring(space, "test", to_camera, from_srgb, neutral=neutral if lit else None)


def seen(camera, light, space="linear-srgb", known=KNOWN, **how):
    """Return the balance, and what colors in linear sRGB are to the camera over the white."""
    white = camera @ (light * known)
    from_srgb = SPACES[space].from_srgb
    found = balance(coloring(camera, space, **how), 7.0 * white, from_srgb @ known)
    return found, lambda srgb: (srgb * light) @ camera.T / white


@settings(max_examples=25)
@given(cameras, lights, colors, spaces)
def test_a_camera_of_mixed_primaries_is_balanced_by_these(camera, light, srgb, space):
    found, rates = seen(camera, light, space)
    np.testing.assert_allclose(
        rates(srgb) @ found.by_primaries.T, srgb @ SPACES[space].from_srgb.T, atol=1e-9
    )


@settings(max_examples=25)
@given(lights, colors)
def test_a_camera_of_narrow_filters_is_balanced_by_channels(light, srgb):
    found, rates = seen(np.diag([0.5, 1.0, 0.6]), light)
    np.testing.assert_allclose(rates(srgb) @ found.by_channels.T, srgb, atol=1e-12)
    # then both models are one, and nothing is open
    np.testing.assert_allclose(found.model_sigma(srgb), 0.0, atol=1e-12)


@settings(max_examples=25)
@given(cameras, lights, spaces, st.floats(0.01, 0.5))
def test_grey_is_exact_whatever_the_light(camera, light, space, factor):
    found, rates = seen(camera, light, space)
    grey = np.full((1, 3), factor)
    by_mean = rates(grey) @ found.matrix.T
    np.testing.assert_allclose(by_mean, grey @ SPACES[space].from_srgb.T, atol=1e-9)
    np.testing.assert_allclose(found.model_sigma(by_mean), 0.0, atol=1e-9)


def test_what_is_open_is_a_share_of_the_distance_of_the_models():
    found, rates = seen(CAMERA_FROM_SRGB, np.array([0.96, 1.0, 1.012]))
    red = np.array([[0.09, 0.04, 0.014]])
    one, other = (rates(red) @ each.T for each in (found.by_channels, found.by_primaries))
    rms = np.sqrt(((one - other) ** 2).mean())
    assert 0.002 < rms / red.max() < 0.02
    mean = one + PRIMARIES * (other - one)
    np.testing.assert_allclose(found.model_sigma(mean), MODEL_SHARE * rms)


@settings(max_examples=25)
@given(cameras, lights, colors, spaces, st.booleans())
def test_what_white_frames_err_by_is_the_derivative(camera, light, srgb, space, lit):
    known = np.array([0.3, 0.25, 0.2])
    found, rates = seen(camera, light, space, known, lit=lit)
    value = rates(srgb) @ found.matrix.T
    white, step = camera @ (light * known), 1e-6
    for channel in range(3):
        # a white that is too bright in one channel, and samples as they are
        off = 1.0 + step * np.eye(3)[channel]
        from_srgb = SPACES[space].from_srgb
        shifted = balance(coloring(camera, space, lit=lit), white * off, from_srgb @ known)
        change = (rates(srgb) / off @ shifted.matrix.T - value) / step
        np.testing.assert_allclose(
            found.through_white(value)[..., channel], change, rtol=1e-3, atol=1e-4
        )


def test_where_the_light_is_not_told_channels_are_balanced():
    found, _ = seen(CAMERA_FROM_SRGB, np.ones(3), lit=False)
    np.testing.assert_array_equal(found.matrix, found.by_channels)
    assert not found.model_sigma(np.array([[0.1, 0.02, 0.01]])).any()


@pytest.mark.parametrize("blue", [-0.01, -0.2])
def test_of_a_primary_that_the_light_lacks_nothing_is_told(blue):
    found, rates = seen(CAMERA_FROM_SRGB, np.array([1.3, 1.0, blue]))
    truth = np.random.default_rng(0).uniform(0.02, 0.3, (200, 3))
    value = rates(truth) @ found.by_channels.T
    np.testing.assert_array_equal(found.matrix, found.by_channels)
    z = (value - truth) / found.model_sigma(value)
    # the twin's filters are mixtures of the primaries, for which channels alone are wrong
    assert 0.3 < np.sqrt(np.mean(z**2)) < 1.6
    assert (found.model_sigma(value)[:, 2] >= KNOWN[2] / np.sqrt(3)).all()
