import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.directions import from_degrees, normalize
from nnbrdf.analytic import (
    AnisotropicGGX,
    CoatedDiffuse,
    Fibers,
    Lambert,
    OrenNayar,
    Rotated,
    Sheen,
    Sum,
)
from sim.materials import EMBEDDED

WHITE = (1.0, 1.0, 1.0)
COLOR = (0.7, 0.4, 0.1)
MODELS = {
    "lambert": Lambert(COLOR),
    "oren-nayar": OrenNayar(COLOR, 0.8),
    "coated-diffuse": CoatedDiffuse(COLOR, 0.04),
    "ggx": AnisotropicGGX(COLOR, 0.3, 0.3),
    "ggx-narrow": AnisotropicGGX(COLOR, 0.03, 0.03),
    "ggx-anisotropic": AnisotropicGGX(COLOR, 0.1, 0.5, phi=0.7),
    "fibers": Fibers(COLOR, width=0.2, tilt=0.2, phi=1.0),
    "sheen": Sheen(COLOR, 0.3),
    "sum": Sum((Lambert(COLOR), AnisotropicGGX(COLOR, 0.2, 0.4))),
    "rotated": Rotated(AnisotropicGGX(COLOR, 0.2, 0.4), 0.5),
}
each_model = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)

directions = st.builds(from_degrees, st.floats(0, 90), st.floats(0, 360))


def albedo(material, light, nodes=160):
    """Directional albedo by quadrature over angles from the mirror direction, where lobes are."""
    place, weight = np.polynomial.legendre.leggauss(nodes)
    place, weight = (place + 1) / 2, weight / 2
    # cubed, so that the nodes crowd where a narrow lobe peaks
    angle = np.pi * place**3
    ring = weight * 3 * np.pi * place**2 * np.sin(angle) * 2 * np.pi / nodes
    turn = 2 * np.pi * (np.arange(nodes) + 0.5) / nodes
    axis = light * [-1, -1, 1]
    side = normalize(np.cross(axis, [0.0, 1.0, 0.0]))
    around = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * np.cross(axis, side)
    view = np.cos(angle)[:, None, None] * axis + np.sin(angle)[:, None, None] * around
    cosine = np.clip(view[..., 2:], 0, None)
    return np.sum(material.evaluate(light, view) * cosine * ring[:, None, None], axis=(0, 1))


@each_model
@given(light=directions, view=directions)
def test_reciprocal_finite_and_not_negative(model, light, view):
    value = model.evaluate(light, view)
    assert np.isfinite(value).all()
    assert (value >= 0).all()
    np.testing.assert_allclose(value, model.evaluate(view, light), rtol=1e-9, atol=1e-300)


@each_model
def test_nothing_at_or_below_the_horizon(model):
    above = from_degrees(30, 10)
    below = [from_degrees(90, 200), np.array([1.0, 0, 0]), -above, np.array([0, 0, -1.0])]
    for direction in below:
        assert not model.evaluate(above, direction).any()
        assert not model.evaluate(direction, above).any()
        assert not model.evaluate(direction, direction).any()


@each_model
@pytest.mark.parametrize(
    "pair",
    [
        (from_degrees(40, 70), from_degrees(40, 70)),
        (from_degrees(0, 0), from_degrees(0, 0)),
        (from_degrees(89.9999, 0), from_degrees(89.9999, 180)),
        (from_degrees(89.9999, 20), from_degrees(89.9999, 20)),
    ],
    ids=["coincident", "normal", "opposite at grazing", "coincident at grazing"],
)
def test_awkward_pairs(model, pair):
    value = model.evaluate(*pair)
    assert np.isfinite(value).all()
    assert (value >= 0).all()


@each_model
def test_broadcasts(model):
    light = from_degrees([10, 50], [0, 90])[:, None]
    view = from_degrees([0, 30, 60], [0, 120, 300])
    value = model.evaluate(light, view)
    assert value.shape == (2, 3, 3)
    assert value.dtype == np.float64
    np.testing.assert_allclose(value[1, 2], model.evaluate(light[1, 0], view[2]), rtol=1e-12)


@pytest.mark.parametrize(
    ("material", "theta_deg", "expected"),
    [
        (Lambert(WHITE), 60, 1.0),
        (OrenNayar(WHITE, 0.0), 60, 1.0),
        (AnisotropicGGX(WHITE, 1.0, 1.0), 0, 1.0 - math.log(2.0)),
        # a nearly perfect mirror loses next to nothing
        (AnisotropicGGX(WHITE, 0.01, 0.01), 0, 1.0),
        # 28 / (23 pi) is one over the integral of the view's factor, so the light's remains
        (CoatedDiffuse(WHITE, 0.0), 60, 1.0 - 0.75**5),
    ],
    ids=["lambert", "smooth oren-nayar", "ggx of alpha 1", "ggx mirror", "coated"],
)
def test_albedo_in_closed_form(material, theta_deg, expected):
    light = from_degrees(theta_deg, 25)
    np.testing.assert_allclose(albedo(material, light), expected, rtol=2e-3)


@pytest.mark.parametrize("theta_deg", [0, 30, 60, 80, 88])
@pytest.mark.parametrize(
    "model",
    [
        OrenNayar(WHITE, 1.0),
        CoatedDiffuse(WHITE, 0.04),
        AnisotropicGGX(WHITE, 0.1, 0.1),
        AnisotropicGGX(WHITE, 0.6, 0.2),
        Sheen(WHITE, 0.3),
    ],
)
def test_white_furnace(model, theta_deg):
    assert (albedo(model, from_degrees(theta_deg, 50)) <= 1.001).all()


@pytest.mark.parametrize("theta_deg", [0, 45, 75, 88])
@pytest.mark.parametrize("name", EMBEDDED)
def test_embedded_materials_reflect_no_more_than_they_get(name, theta_deg):
    for phi_deg in (0, 45, 90):
        reflected = albedo(EMBEDDED[name].material, from_degrees(theta_deg, phi_deg))
        assert (reflected > 0.005).all()
        assert (reflected <= 1.0).all()


def test_grooves_along_x_draw_the_highlight_out_across_them():
    metal = AnisotropicGGX(WHITE, alpha_x=0.05, alpha_y=0.4)
    normal = from_degrees(0, 0)
    along, across = metal.evaluate(normal, from_degrees([40, 40], [0, 90]))
    assert (across > 20 * along).all()


def test_phi_turns_as_rotation_does():
    light, view = from_degrees(35, 20), from_degrees([10, 50, 70], [0, 100, 250])
    for make in (
        lambda phi: AnisotropicGGX(COLOR, 0.1, 0.4, phi=phi),
        lambda phi: Fibers(COLOR, width=0.2, tilt=0.1, phi=phi),
    ):
        turned = Rotated(make(0.0), 0.6).evaluate(light, view)
        np.testing.assert_allclose(make(0.6).evaluate(light, view), turned, rtol=1e-9)
        assert not np.allclose(make(0.0).evaluate(light, view), turned)


def test_phi_turns_from_x_towards_y():
    grooves = AnisotropicGGX(WHITE, alpha_x=0.05, alpha_y=0.4, phi=math.radians(30))
    streak, mirrored = grooves.evaluate(from_degrees(0, 0), from_degrees([40, 40], [120, 60]))
    assert (streak > 20 * mirrored).all()


def test_tilted_fibers_tilt_the_highlight():
    # inside, the highlight leaves at twice the tilt; Snell's law takes it out
    tilt = math.radians(10)
    wood = Fibers(WHITE, width=0.01, tilt=tilt)
    theta_deg = np.arange(0, 60, 0.05)
    value = wood.evaluate(from_degrees(0, 0), from_degrees(theta_deg, np.full(len(theta_deg), 180)))
    expected = math.degrees(math.asin(1.5 * math.sin(2 * tilt)))
    assert theta_deg[np.argmax(value[:, 0])] == pytest.approx(expected, abs=0.1)


def test_sum_adds():
    light, view = from_degrees(20, 0), from_degrees(50, 90)
    parts = (Lambert(COLOR), Sheen(WHITE, 0.5), OrenNayar(COLOR, 0.2))
    expected = sum(part.evaluate(light, view) for part in parts)
    np.testing.assert_allclose(Sum(parts).evaluate(light, view), expected)
