"""The models of the literature: what each claims holds, and what it does not claim does not."""

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import qmc

from gonio.directions import from_degrees, from_spherical, normalize
from gonio.errors import BadInputError
from nnbrdf.analytic import AnisotropicGGX, Lambert, OrenNayar
from nnbrdf.fitting.family import Pairs
from nnbrdf.fitting.models import MODELS, model_named

each = pytest.mark.parametrize("family", MODELS.values(), ids=MODELS)
RECIPROCAL = [family for family in MODELS.values() if family.reciprocal]
BOUNDED = [family for family in MODELS.values() if family.bounded]
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


@pytest.mark.parametrize("family", RECIPROCAL, ids=lambda family: family.name)
@settings(max_examples=60)
@given(light=directions, view=directions, place=places)
def test_reciprocal_where_claimed(family, light, view, place):
    one = material(family, place)
    assert np.allclose(one.evaluate(light, view), one.evaluate(view, light), rtol=1e-6, atol=1e-12)


def test_what_claims_no_reciprocity_has_none():
    light, view = from_degrees(30, 0), from_degrees(60, 170)
    for family in MODELS.values():
        one = material(family, [0.5] * 6)
        differ = not np.allclose(one.evaluate(light, view), one.evaluate(view, light), rtol=1e-3)
        assert differ == (not family.reciprocal), family.name


LIGHT, VIEW = from_degrees(30, 20), from_degrees(50, 100)
BODY = 1 / math.pi


def by_hand(phi=0.0):
    """Return cosines of light, view, half vector and light to it, and its slopes along x and y.

    As seen from a frame turned by `phi`.
    """
    lx, ly, lz = seen_from(phi, 30, 20)
    vx, vy, vz = seen_from(phi, 50, 100)
    length = math.sqrt((lx + vx) ** 2 + (ly + vy) ** 2 + (lz + vz) ** 2)
    between = lx * vx + ly * vy + lz * vz
    # half of the angle between the two
    beside = math.sqrt((1 + between) / 2)
    return lz, vz, (lz + vz) / length, beside, (lx + vx) / (lz + vz), (ly + vy) / (lz + vz)


def seen_from(phi, theta_deg, phi_deg):
    theta, azimuth = math.radians(theta_deg), math.radians(phi_deg) - phi
    return (
        math.sin(theta) * math.cos(azimuth),
        math.sin(theta) * math.sin(azimuth),
        math.cos(theta),
    )


def fresnel(f0, beside):
    return f0 + (1 - f0) * (1 - beside) ** 5


def mirrored():
    """Cosine between the view and the mirrored light."""
    (lx, ly, lz), (vx, vy, vz) = seen_from(0, 30, 20), seen_from(0, 50, 100)
    return lz * vz - lx * vx - ly * vy


def lambert():
    return (BODY,)


def minnaert():
    light, view = math.cos(math.radians(30)), math.cos(math.radians(50))
    return ((1.7 + 1) / (2 * math.pi) * (light * view) ** 0.7,)


def oren_nayar():
    # Fujii's A and B; both azimuths on one side, so t is the larger cosine
    a = 1 / (math.pi + (math.pi / 2 - 2 / 3) * 0.6)
    s = math.sin(math.radians(30)) * math.sin(math.radians(50)) * math.cos(math.radians(80))
    return (a + 0.6 * a * s / math.cos(math.radians(30)),)


def phong():
    return BODY, (5 + 2) / (2 * math.pi) * mirrored() ** 5


def blinn_phong():
    half = by_hand()[2]
    return BODY, 14 * 16 / (8 * math.pi * (2**-6 + 12)) * half**12


def strauss():
    smooth, metal = 0.6, 0.3
    light, view = 30 / 90, 50 / 90

    def f(x):
        return (1 / (x - 1.12) ** 2 - 1 / 1.12**2) / (1 / (1 - 1.12) ** 2 - 1 / 1.12**2)

    def g(x):
        return (1 / (1 - 1.01) ** 2 - 1 / (x - 1.01) ** 2) / (1 / (1 - 1.01) ** 2 - 1 / 1.01**2)

    diffuse = 1 - smooth**3
    normal = 1 - diffuse
    strength = min(1, normal + (normal + 0.1) * f(light) * g(light) * g(view))
    lobe = strength * mirrored() ** (3 / (1 - smooth)) / (math.pi * math.cos(math.radians(30)))
    # of the highlight, metals color what is not Fresnel's
    surface = (1 - metal * smooth) * diffuse / math.pi + metal * (1 - f(light)) * lobe
    return surface, (1 - metal * (1 - f(light))) * lobe


def lafortune():
    (lx, ly, lz), (vx, vy, vz) = seen_from(0.4, 30, 20), seen_from(0.4, 50, 100)
    cosine = -0.9 * lx * vx - 0.7 * ly * vy + 0.95 * lz * vz
    return BODY, (8 + 2) / (2 * math.pi) * cosine**8


def schlick():
    light, view, half, beside, x, y = by_hand(0.4)
    r, p = 0.2, 0.5
    zenith = r / (1 + r * half**2 - half**2) ** 2
    # squared cosine between the grain and the half vector's projection
    along = x * x / (x * x + y * y)
    azimuth = math.sqrt(p / (p * p - p * p * along + along))
    seen = light / (r - r * light + light) * view / (r - r * view + view)
    lobe = (1 - seen) / math.pi + seen * zenith * azimuth / (4 * math.pi * light * view)
    return BODY, lobe * fresnel(0.1, beside)


def cook_torrance():
    light, view, half, beside, x, y = by_hand()
    facets = math.exp(-(x * x + y * y) / 0.3**2) / (math.pi * 0.3**2 * half**4)
    shadow = min(1, 2 * half * view / beside, 2 * half * light / beside)
    return BODY, facets * shadow * fresnel(0.1, beside) / (4 * light * view)


def torrance_sparrow():
    light, view, half, beside, _, _ = by_hand()
    facets = math.exp(-((math.acos(half) / 0.3) ** 2)) / (math.pi * 0.3**2)
    shadow = min(1, 2 * half * view / beside, 2 * half * light / beside)
    return BODY, facets * shadow * fresnel(0.1, beside) / (4 * light * view)


def ward():
    light, view, _, _, x, y = by_hand(0.4)
    facets = math.exp(-((x / 0.2) ** 2) - (y / 0.5) ** 2) / (4 * math.pi * 0.2 * 0.5)
    return BODY, facets / math.sqrt(light * view)


def ward_bounded():
    _, _, half, beside, x, y = by_hand(0.4)
    facets = math.exp(-((x / 0.2) ** 2) - (y / 0.5) ** 2) / (math.pi * 0.2 * 0.5)
    return BODY, facets / (4 * beside**2 * half**4)


def ashikhmin_shirley():
    light, view, half, beside, x, y = by_hand(0.4)
    # n_u cos^2 + n_v sin^2 of the half vector's azimuth
    exponent = (20 * x * x + 5 * y * y) / (x * x + y * y)
    scale = math.sqrt((20 + 1) * (5 + 1)) / (8 * math.pi)
    lobe = scale * half**exponent / (beside * max(light, view)) * fresnel(0.1, beside)
    body = 28 / (23 * math.pi) * (1 - (1 - light / 2) ** 5) * (1 - (1 - view / 2) ** 5)
    return body, lobe


def edwards():
    light, view, half, beside, _, _ = by_hand()
    density = 11 / math.pi * (half * half) ** 10 * half
    return BODY, density / (4 * beside * max(light, view)) * fresnel(0.1, beside)


def ggx_lobe(alpha_x, alpha_y):
    _, _, half, beside, x, y = by_hand(0.4)
    stretched = 1 + (x / alpha_x) ** 2 + (y / alpha_y) ** 2
    facets = 1 / (math.pi * alpha_x * alpha_y * half**4 * stretched**2)
    light, view = seen_from(0.4, 30, 20), seen_from(0.4, 50, 100)
    hidden = 0
    for x, y, z in (light, view):
        # Smith's Lambda
        hidden += (math.sqrt(1 + ((alpha_x * x) ** 2 + (alpha_y * y) ** 2) / z**2) - 1) / 2
    return facets / (1 + hidden) * fresnel(0.1, beside) / (4 * light[2] * view[2])


def ggx():
    return BODY, ggx_lobe(0.2, 0.5)


def ggx_two_lobes():
    return BODY, ggx_lobe(0.2, 0.5), ggx_lobe(0.7, 0.3)


BY_HAND = {
    "lambert": ((), lambert),
    "minnaert": ((1.7,), minnaert),
    "oren-nayar": ((0.6,), oren_nayar),
    "phong": ((5.0,), phong),
    "blinn-phong": ((12.0,), blinn_phong),
    "strauss": ((0.6, 0.3), strauss),
    "cook-torrance": ((0.3, 0.1), cook_torrance),
    "lafortune": ((-0.9, -0.7, 0.95, 8.0, 0.4), lafortune),
    "schlick": ((0.2, 0.5, 0.1, 0.4), schlick),
    "ward": ((0.2, 0.5, 0.4), ward),
    "ward-bounded": ((0.2, 0.5, 0.4), ward_bounded),
    "ashikhmin-shirley": ((20.0, 5.0, 0.1, 0.4), ashikhmin_shirley),
    "edwards": ((10.0, 0.1), edwards),
    "torrance-sparrow": ((0.3, 0.1), torrance_sparrow),
    "ggx": ((0.2, 0.5, 0.1, 0.4), ggx),
    "ggx-two-lobes": ((0.2, 0.5, 0.7, 0.3, 0.1, 0.4), ggx_two_lobes),
}


@each
def test_values_by_hand(family):
    shape, value = BY_HAND[family.name]
    # a channel shows a term
    shown = family.material(np.array(shape), np.eye(3)[: len(family.terms)])
    terms = [*value(), 0, 0][:3]
    assert shown.evaluate(LIGHT, VIEW) == pytest.approx(terms, rel=1e-12)


def awkward_directions():
    """The pole, the horizon and what is next to either; mirrored and opposite among each other."""
    theta, phi = [0, 1e-6, 45, 89.9, 89.999999, 90 - 1e-9, 90], [0, 0.001, 25, 90, 180, 205, 270]
    lowest = [[x, y, 1.1e-12] for x, y in ((1, 0), (-1, 0), (0.6, 0.8), (-0.6, -0.8))]
    return np.concatenate([from_degrees(*np.meshgrid(theta, phi)).reshape(-1, 3), lowest])


@each
def test_finite_at_the_corners_of_the_box_for_awkward_pairs(family):
    direction = awkward_directions()
    for place in product((0.0, 1.0), repeat=len(family.shape)):
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            value = material(family, place).evaluate(direction[:, None], direction[None])
        assert np.isfinite(value).all(), place
        assert (value >= 0).all(), place


@given(
    height=st.tuples(st.floats(-11.9, -2), st.floats(-11.9, -2)),
    phi=st.floats(0, 6),
    off=st.floats(-1e-3, 1e-3),
)
def test_finite_where_both_graze_from_opposite_sides(height, phi, off):
    # light and half vector are all but perpendicular here, and some models divide by their cosine
    light, view = (
        from_spherical(np.arccos(10.0**power), azimuth)
        for power, azimuth in zip(height, (phi, phi + np.pi + off), strict=True)
    )
    for family in MODELS.values():
        assert np.isfinite(material(family, [0.5] * 6).evaluate(light, view)).all(), family.name


def albedos(family, shape, light, nodes=120):
    """Directional albedo of each term of color 1, by quadrature over half vectors."""
    place, weight = np.polynomial.legendre.leggauss(nodes)
    place, weight = (place + 1) / 2, weight / 2
    theta = np.pi / 2 * place**4  # nodes crowd about the normal, where half vectors peak
    ring = weight * 2 * np.pi * place**3 * np.sin(theta)
    phi = 2 * np.pi * (np.arange(nodes) + 0.5) / nodes
    half = from_spherical(theta[:, None], phi).reshape(-1, 3)
    cosine = half @ light
    view = 2 * cosine[:, None] * half - light
    # views by way of half vectors: solid angles grow by 4 l.h
    measure = 4 * cosine.clip(0) * view[:, 2].clip(0) * np.repeat(ring, nodes) * 2 * np.pi / nodes
    seen = measure > 0
    pairs = Pairs.of(np.broadcast_to(light, view.shape)[seen], normalize(view[seen]))
    return measure[seen] @ family.evaluate(pairs, np.array(shape))


def boxes(family):
    """Shapes over the whole box: a Latin hypercube, and corners."""
    count = len(family.shape)
    corners = list(product((0.0, 1.0), repeat=count))
    rng = np.random.default_rng(0)
    chosen = rng.permutation(len(corners))[:12]
    inside = qmc.LatinHypercube(count, rng=rng).random(12) if count else []
    for place in [*inside, *(corners[index] for index in chosen)]:
        yield [each.at(at) for each, at in zip(family.shape, place, strict=True)]


@pytest.mark.parametrize("family", BOUNDED, ids=lambda family: family.name)
def test_no_term_returns_more_than_it_gets_where_claimed(family):
    for shape in boxes(family):
        for theta_deg in (0, 40, 75, 86, 89.5):
            got = albedos(family, shape, from_degrees(theta_deg, 25))
            assert (got < 1.003).all(), (shape, theta_deg, got)


def test_the_quadrature_is_good():
    lambert, phong = MODELS["lambert"], MODELS["phong"]
    for theta_deg in (0, 60, 88):
        light = from_degrees(theta_deg, 0)
        assert albedos(lambert, [], light) == pytest.approx([1.0], abs=1e-3)
    # Phong's normalization is exact at normal incidence, whatever the exponent
    assert albedos(phong, [50.0], from_degrees(0, 0))[1] == pytest.approx(1.0, abs=1e-3)
    # Minnaert's albedo has a closed form
    got = albedos(MODELS["minnaert"], [2.0], from_degrees(60, 0))
    assert got == pytest.approx([0.5], abs=1e-3)


UNBOUNDED = {
    "minnaert": ([0.5], 60, 0, 1.41),
    "lafortune": ([-1.1, -1.1, 1.1, 20.0, 0.0], 30, 1, 5.83),
    "schlick": ([0.05, 1.0, 1.0, 0.0], 88, 1, 2.00),
    "strauss": ([0.7, 0.0], 89.5, 1, 1.41),
    "ward": ([1.0, 1.0, 0.0], 89.9, 1, 1.50),
}
"""Shape, incidence in degrees, number of the term, its albedo by quadrature over views."""


@pytest.mark.parametrize("name", UNBOUNDED)
def test_what_claims_no_bound_has_a_term_that_breaks_it(name):
    shape, theta_deg, term, expected = UNBOUNDED[name]
    got = albedos(MODELS[name], shape, from_degrees(theta_deg, 25), nodes=400)[term]
    assert got > 1.2
    assert got == pytest.approx(expected, rel=0.03)


def test_each_model_is_tested_as_what_it_claims():
    assert {family.name for family in BOUNDED} | set(UNBOUNDED) == set(MODELS)
    assert not {family.name for family in BOUNDED} & set(UNBOUNDED)


@pytest.mark.parametrize(
    ("family", "shape", "twin"),
    [
        ("ggx", [0.1, 0.5, 1.0, 0.7], AnisotropicGGX((1.0, 1.0, 1.0), 0.1, 0.5, phi=0.7)),
        ("oren-nayar", [0.6], OrenNayar((1.0, 1.0, 1.0), 0.6)),
        ("lambert", [], Lambert((1.0, 1.0, 1.0))),
    ],
)
def test_the_twins_materials_are_these(family, shape, twin):
    colors = [1.0] if len(MODELS[family].terms) == 1 else [0.0, 1.0]
    assert same(with_shape(family, shape, colors), twin)


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


GRAINED = {
    "lafortune": ([-0.9, 0.4, 0.8, 8.0], (0, 1)),
    "ward": ([0.2, 0.5], (0, 1)),
    "ward-bounded": ([0.2, 0.5], (0, 1)),
    "ashikhmin-shirley": ([20.0, 90.0, 0.1], (0, 1)),
    "ggx": ([0.2, 0.5, 0.1], (0, 1)),
    "ggx-two-lobes": ([0.2, 0.5, 0.7, 0.3, 0.1], (0, 1), (2, 3)),
}


@pytest.mark.parametrize("name", GRAINED)
def test_axes_exchanged_are_a_quarter_turn(name):
    shape, *axes = GRAINED[name]
    exchanged = list(shape)
    for x, y in axes:
        exchanged[x], exchanged[y] = shape[y], shape[x]
    colors = [0.2, 0.5, 0.3][: len(MODELS[name].terms)]
    one = with_shape(name, [*shape, 0.3], colors)
    assert same(one, with_shape(name, [*exchanged, 0.3 + np.pi / 2], colors))
    assert not same(one, with_shape(name, [*exchanged, 0.3], colors))


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
