"""Sampled against evaluated density, energy against quadrature, and bounded weights."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from gonio.directions import from_degrees, from_spherical, half_vector, normalize
from nnbrdf.albedo import directional_albedo
from nnbrdf.analytic import AnisotropicGGX, Lambert, OrenNayar, Sum
from nnbrdf.sampling import Sampler
from nnbrdf.sampling.cells import AREA, SECTORS, Cells

MATERIALS = {
    "matte": OrenNayar((0.5, 0.4, 0.3), 0.6),
    "glossy": Sum((Lambert((0.3, 0.2, 0.1)), AnisotropicGGX((0.04, 0.04, 0.04), 0.2, 0.2))),
    "mirror": AnisotropicGGX((0.9, 0.9, 0.9), 0.02, 0.02),
    "anisotropic": Sum((Lambert((0.05,) * 3), AnisotropicGGX((0.6,) * 3, 0.05, 0.3, 0.4))),
}
LIGHTS_DEG = (0.0, 80.0)
DRAWS = 40_000
RINGS, SECTORS_OF_BINS = 12, 6
# under light along the normal cells and bins are concentric: fine rings, and steps that fit sectors
ACROSS, AROUND = 120, 16
# of all tests of densities together, so that each passes with this share of it (Bonferroni)
SIGNIFICANCE = 0.01
each_material = pytest.mark.parametrize("name", MATERIALS)


@cache
def sampler_of(name):
    return Sampler.of(MATERIALS[name])


def uniform(count, seed=3):
    return np.random.default_rng(seed).random((count, 2))


def frame_about(axis):
    first = normalize(np.cross(axis, [0.0, 1.0, 0.0] if abs(axis[1]) < 0.9 else [1.0, 0.0, 0.0]))
    return np.stack([first, np.cross(axis, first), axis])


class Bins:
    """Rings and sectors about the mirrored direction, where densities are steep."""

    def __init__(self, light):
        self.frame = frame_about(light * [-1, -1, 1])
        share = np.linspace(0, 1, RINGS + 1)
        self.edges = np.pi * np.sinh(6 * share) / np.sinh(6)

    def counts(self, view):
        x, y, z = self.frame @ view.T
        angle, around = np.arctan2(np.hypot(x, y), z), np.arctan2(y, x) % (2 * np.pi)
        limits = (self.edges, np.linspace(0, 2 * np.pi, SECTORS_OF_BINS + 1))
        return np.histogram2d(angle, around, limits)[0]

    def expected(self, density):
        """Integrals of a density by midpoints, ACROSS x AROUND in each bin."""
        steps, turns = (np.arange(ACROSS) + 0.5) / ACROSS, SECTORS_OF_BINS * AROUND
        angle = (self.edges[:-1, None] + np.diff(self.edges)[:, None] * steps).ravel()
        around = 2 * np.pi * (np.arange(turns) + 0.5) / turns
        view = from_spherical(angle[:, None], around) @ self.frame
        weight = np.repeat(np.diff(self.edges) / ACROSS, ACROSS) * np.sin(angle)
        mass = density(view) * weight[:, None] * 2 * np.pi / turns
        return mass.reshape(RINGS, ACROSS, SECTORS_OF_BINS, AROUND).sum(axis=(1, 3))


def chi_square_p(counts, expected):
    """Of Pearson's test, all bins of few expected taken together, and what was lost as one more."""
    counts = np.append(counts, DRAWS - counts.sum())
    expected = np.append(DRAWS * expected, DRAWS * (1 - expected.sum())).clip(0)
    few = expected < 10
    seen, told = counts[~few], expected[~few]
    if expected[few].sum() > 5:
        seen, told = np.append(seen, counts[few].sum()), np.append(told, expected[few].sum())
    return stats.chi2.sf(np.sum((seen - told) ** 2 / told), len(seen) - 1)


@each_material
@pytest.mark.parametrize("theta_deg", LIGHTS_DEG)
def test_views_are_drawn_with_the_density_that_is_told(name, theta_deg):
    sampler, light = sampler_of(name), from_degrees(theta_deg, 35.0)
    view, pdf = sampler.sample(light, uniform(DRAWS))
    bins = Bins(light)
    p = chi_square_p(
        bins.counts(view[pdf > 0]), bins.expected(lambda view: sampler.pdf(light, view))
    )
    assert p > SIGNIFICANCE / (len(MATERIALS) * len(LIGHTS_DEG))


def weights(name, light, count=DRAWS):
    view, pdf = sampler_of(name).sample(light, uniform(count))
    drawn = pdf > 0
    result = np.zeros((count, 3))
    values = MATERIALS[name].evaluate(light, view[drawn]) * view[drawn, 2:]
    result[drawn] = values / pdf[drawn, None]
    return result


@each_material
def test_energy_by_samples_is_that_of_quadrature_and_no_weight_is_far_above_it(name):
    for albedo in directional_albedo(MATERIALS[name], azimuths=1):
        drawn = weights(name, from_degrees(albedo.incidence_deg, 0.0))
        error = drawn.std(axis=0) / np.sqrt(DRAWS) + albedo.error
        assert (np.abs(drawn.mean(axis=0) - albedo.value) < 4 * error).all()
        assert drawn.max() < 6 * max(albedo.value)


@each_material
def test_variance_against_sampling_by_the_cosine(name):
    light = from_degrees(60.0, 20.0)
    u = uniform(DRAWS, seed=9)
    sine, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    by_cosine = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=-1)
    plain = np.pi * MATERIALS[name].evaluate(light, by_cosine)[:, 1]
    least = {"matte": 5, "glossy": 50, "mirror": 1000, "anisotropic": 100}[name]
    assert plain.var() > least * weights(name, light)[:, 1].var()


@settings(max_examples=60)
@given(
    theta_deg=st.floats(0, 90), phi_deg=st.floats(-400, 400),
    u=st.tuples(*[st.floats(0, 1, exclude_max=True)] * 2),
    name=st.sampled_from(["matte", "mirror"]),
)  # fmt: skip
def test_any_draw_is_a_direction_whose_density_is_told(theta_deg, phi_deg, u, name):
    light = from_degrees(theta_deg, phi_deg)
    view, pdf = sampler_of(name).sample(light, np.array(u))
    assert np.linalg.norm(view) == pytest.approx(1)
    assert np.isfinite(pdf)
    assert pdf == pytest.approx(sampler_of(name).pdf(light, view), rel=1e-12)
    assert (pdf > 0) == (view[2] > 0 and light[2] > 0)


def test_shapes_broadcast():
    lights = from_degrees([0.0, 30.0], 0.0)
    view, pdf = sampler_of("glossy").sample(lights[:, None], uniform(5))
    assert view.shape == (2, 5, 3)
    assert pdf.shape == (2, 5)
    assert sampler_of("glossy").pdf(lights[:, None], view).shape == (2, 5)


def test_a_grain_is_noticed():
    assert sampler_of("anisotropic").azimuths > 1
    assert sampler_of("glossy").azimuths == 1


def test_below_the_horizon_nothing_is_drawn():
    down = -from_degrees(40.0, 10.0)
    sampler = sampler_of("glossy")
    assert (sampler.sample(down, uniform(10))[1] == 0).all()
    assert sampler.pdf(from_degrees(20.0, 0.0), down) == 0


class Broken:
    """Black, but for what is not finite or below zero."""

    def evaluate(self, light, view):
        values = np.zeros(np.broadcast_shapes(light.shape, view.shape))
        values[view[..., 0] > 0.5] = np.nan
        values[view[..., 0] < -0.5] = -1
        return values


def test_a_black_material_is_drawn_from_as_any():
    view, pdf = Sampler.of(Broken()).sample(from_degrees(30.0, 0.0), uniform(100))
    assert np.isfinite(view).all()
    assert (pdf[view[:, 2] > 0] > 0).all()


def test_densities_of_half_vectors_are_shares_of_cells_over_their_areas():
    mass = np.zeros((2, len(AREA), SECTORS))
    mass[0, 5, 7] = mass[1, 20, 0] = 1.0
    cells, which = Cells(mass), np.array([0, 1]).repeat(50)
    half = cells.draw(which, uniform(100))
    assert cells.density(which, half) == pytest.approx(1 / AREA[[5, 20]].repeat(50))
    assert (cells.density(1 - which, half) == 0).all()
    assert half_vector(half, half) == pytest.approx(half)
