"""The models of the literature: what each claims holds, and what it does not claim does not."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gonio.directions import from_degrees
from gonio.errors import BadInputError
from nnbrdf.fitting.models import MODELS, model_named

each = pytest.mark.parametrize("family", MODELS.values(), ids=MODELS)
directions = st.builds(from_degrees, st.floats(0, 90), st.floats(0, 360))
places = st.lists(st.floats(0, 1), min_size=6, max_size=6)


def material(family, place, color=1.0):
    shape = [each.at(at) for each, at in zip(family.shape, place, strict=False)]
    return family.material(np.array(shape), np.full((len(family.terms), 3), color))


@each
@settings(max_examples=60)
@given(light=directions, view=directions, place=places)
def test_finite_and_not_negative_to_the_horizon(family, light, view, place):
    value = material(family, place).evaluate(light, view)
    assert np.isfinite(value).all()
    assert (value >= 0).all()


@each
@settings(max_examples=60)
@given(light=directions, view=directions, place=places)
def test_reciprocal_where_claimed(family, light, view, place):
    if not family.reciprocal:
        pytest.skip("claims none")
    one = material(family, place)
    assert np.allclose(one.evaluate(light, view), one.evaluate(view, light), rtol=1e-6, atol=1e-12)


def test_what_claims_no_reciprocity_has_none():
    light, view = from_degrees(30, 0), from_degrees(60, 170)
    for family in MODELS.values():
        one = material(family, [0.5] * 6)
        differ = not np.allclose(one.evaluate(light, view), one.evaluate(view, light), rtol=1e-3)
        assert differ == (not family.reciprocal), family.name


def albedo(one, light, nodes=160):
    """Directional albedo by quadrature about the half vector, where lobes are."""
    place, weight = np.polynomial.legendre.leggauss(nodes)
    place, weight = (place + 1) / 2, weight / 2
    theta = np.pi / 2 * place**3  # nodes crowd about the normal, where half vectors peak
    ring = weight * 1.5 * np.pi * place**2 * np.sin(theta)
    phi = 2 * np.pi * (np.arange(nodes) + 0.5) / nodes
    half = np.stack(np.broadcast_arrays(
        np.sin(theta)[:, None] * np.cos(phi), np.sin(theta)[:, None] * np.sin(phi),
        np.cos(theta)[:, None]), axis=-1)  # fmt: skip
    cosine = half @ light
    view = 2 * cosine[..., None] * half - light
    # views by way of half vectors: solid angles grow by 4 l.h
    measure = (
        4 * np.clip(cosine, 0, None) * view[..., 2].clip(0) * ring[:, None] * 2 * np.pi / nodes
    )
    return float((one.evaluate(light, view)[..., 0] * measure).sum())


@each
@pytest.mark.parametrize("theta", [0.0, 40.0, 75.0, 88.0])
def test_no_term_returns_more_than_it_gets_where_claimed(family, theta):
    if not family.bounded:
        pytest.skip("claims none")
    rng = np.random.default_rng(0)
    boxes = [*rng.random((5, 6)), np.zeros(6), np.ones(6)]
    for place in boxes:
        shape = np.array([each.at(at) for each, at in zip(family.shape, place, strict=False)])
        for term in range(len(family.terms)):
            color = np.zeros((len(family.terms), 3))
            color[term] = 1.0
            got = albedo(family.material(shape, color), from_degrees(theta, 25.0))
            assert got < 1.01, (family.terms[term], shape)


def test_the_quadrature_is_good():
    lambert = material(MODELS["lambert"], [])
    assert albedo(lambert, from_degrees(60, 0)) == pytest.approx(1, abs=2e-3)


UNBOUNDED = {"minnaert": [0.0], "ward": [0.7, 0.7, 0.0], "lafortune": [0.0, 0.0, 1.0, 0.5, 0.0],
             "schlick": [1.0, 1.0, 1.0, 0.0]}  # fmt: skip


@pytest.mark.parametrize(("name", "place"), UNBOUNDED.items())
def test_what_claims_no_bound_has_none(name, place):
    family = MODELS[name]
    assert not family.bounded
    assert albedo(material(family, place), from_degrees(88, 0)) > 1.05


def same(first, second):
    rng = np.random.default_rng(1)
    theta, phi = rng.uniform(0, 89, (2, 500)), rng.uniform(0, 360, (2, 500))
    light, view = (from_degrees(theta[i], phi[i]) for i in range(2))
    return np.allclose(first.evaluate(light, view), second.evaluate(light, view), rtol=1e-9)


def with_shape(name, shape, colors):
    return MODELS[name].material(np.array(shape), np.array(colors)[:, None] * np.ones(3))


LIMITS = {
    "oren-nayar without roughness is lambert": (
        with_shape("oren-nayar", [0.0], [0.5]), with_shape("lambert", [], [0.5])),
    "minnaert with k = 1 is lambert": (
        with_shape("minnaert", [1.0], [0.5]), with_shape("lambert", [], [0.5])),
    "lafortune's mirror lobe is phong's": (
        with_shape("lafortune", [-1, -1, 1, 20, 0], [0.2, 0.5]),
        with_shape("phong", [20.0], [0.2, 0.5])),
    "two lobes, one of them black, are one": (
        with_shape("ggx-two-lobes", [0.2, 0.4, 0.6, 0.9, 0.3, 1.0], [0.2, 0.5, 0.0]),
        with_shape("ggx", [0.2, 0.4, 0.3, 1.0], [0.2, 0.5])),
    "strauss without smoothness and metal is its body": (
        with_shape("strauss", [0.0, 0.0], [0.5, 0.0]), with_shape("lambert", [], [0.5])),
    **{
        f"{name} of equal roughness has no grain": (
            with_shape(name, [*both, *rest, 0.0], [0.2, 0.5]),
            with_shape(name, [*both, *rest, 1.0], [0.2, 0.5]))
        for name, both, rest in [
            ("ggx", (0.3, 0.3), (0.1,)), ("ward", (0.3, 0.3), ()), ("ward-bounded", (0.3, 0.3), ()),
            ("ashikhmin-shirley", (30.0, 30.0), (0.1,)), ("schlick", (0.1, 1.0), (0.1,)),
        ]
    },
}  # fmt: skip


@pytest.mark.parametrize(("first", "second"), LIMITS.values(), ids=LIMITS)
def test_limits(first, second):
    assert same(first, second)


def test_a_grain_is_felt():
    assert not same(
        with_shape("ggx", [0.1, 0.5, 0.1, 0.0], [0.2, 0.5]),
        with_shape("ggx", [0.1, 0.5, 0.1, 1.0], [0.2, 0.5]),
    )


@each
def test_it_says_where_it_is_from(family):
    assert any(character.isdigit() for character in family.source)
    assert all(each.low < each.high and each.unit for each in family.shape)


def test_an_unknown_name_lists_the_known():
    with pytest.raises(BadInputError, match="'disney' is not known; use lambert, minnaert"):
        model_named("disney")
