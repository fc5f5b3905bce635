"""Sigma by its causes: what each is, that they add up, and what intervals hold."""

from dataclasses import replace

import numpy as np
import pytest
import xarray
from hypothesis import given
from hypothesis import strategies as st

from gonio.directions import from_spherical
from gonio.materials import Lambertian
from gonio.reduce import reduce_session
from gonio.reduce.slope import misfit, smooth_fit
from gonio.reduce.tolerance import axis_effects, missed_effects, seat_effects
from gonio.samples import Samples
from gonio.uncertainty import COMPONENT_NAMES, COMPONENTS, Uncertainty
from nnbrdf.analytic import AnisotropicGGX, Lambert
from sim.materials import load_material
from tests.draws import (
    STATED,
    Z90,
    Errors,
    constant_sigma,
    covered,
    drawn_samples,
    interval_score,
    small_rig,
)

from .conftest import SMALL_RIG

GREY = Lambert((0.4, 0.4, 0.4))
TWO = [(20, 0, 40, 90), (50, 10, 30, 200)]
STATED_TEXT = """
[uncertainty]
reference = 0.01
angle_deg = 0.02
stray_light = 0.001
"""

ANGLE = np.radians(0.01)
thetas, phis = st.floats(0.0, 1.4), st.floats(0.0, 6.28)


def direction(theta, phi):
    return from_spherical([theta], [phi])


@given(theta=thetas, phi=phis, other=thetas)
def test_the_light_s_theta_tells_by_its_cosine_on_a_diffuser(theta, phi, other):
    effects = axis_effects(Lambertian(0.5), np.array([[theta, phi, other, 1.0]]), ANGLE)
    np.testing.assert_allclose(effects[0], -np.tan(theta) * ANGLE, atol=1e-7)
    np.testing.assert_allclose(effects[1:], 0.0, atol=1e-9)


@given(light=thetas, view=thetas, phi=phis)
def test_turning_either_arm_is_the_same_on_an_isotropic_material(light, view, phi):
    material = AnisotropicGGX((0.5, 0.4, 0.3), 0.3, 0.3)
    effects = axis_effects(material, np.array([[light, phi, view, 0.5]]), ANGLE)
    np.testing.assert_allclose(effects[1], -effects[3], atol=1e-9)


@given(theta=thetas, tilt=st.floats(-0.01, 0.01))
def test_a_tilt_changes_the_cosine_of_a_light_that_it_tips_towards(theta, tilt):
    light = direction(theta, 0.0)
    about_x, about_y, _ = seat_effects(
        Lambertian(0.5), light, direction(0.0, 0.0), tilt_rad=tilt, height_mm=0.0, distance_mm=2e3
    )
    np.testing.assert_allclose(about_x, np.cos(tilt) - 1.0, atol=1e-9)
    np.testing.assert_allclose(about_y, np.cos(theta + tilt) / np.cos(theta) - 1.0, atol=1e-9)


@given(height=st.floats(-2.0, 2.0))
def test_a_higher_face_lies_nearer_to_the_lamps(height):
    up = direction(0.0, 0.0)
    effects = seat_effects(
        Lambertian(0.5), up, up, tilt_rad=0.0, height_mm=height, distance_mm=2000.0
    )
    np.testing.assert_allclose(effects[2], (2000.0 / (2000.0 - height)) ** 2 - 1.0, atol=1e-9)


@pytest.mark.parametrize("name", ["wood-veneer", "velvet"])
def test_slopes_that_the_fit_misses_count(name):
    material, random = load_material(name), np.random.default_rng(2)
    theta, phi = random.uniform(0, 1.3, (2, 100)), random.uniform(0, 6.28, (2, 100))
    arms = np.array([theta[0], phi[0], theta[1], phi[1]]).T
    light, view = (from_spherical(theta[side], phi[side]) for side in (0, 1))
    value = material.evaluate(light, view)
    samples = Samples.from_values(light, view, value, sigma=0.01 * value)
    off, fit = np.radians(0.03) * random.choice([-1.0, 1.0], (100, 4)), smooth_fit(samples)
    moved = from_spherical(*(arms + off).T[:2]), from_spherical(*(arms + off).T[2:])
    sent = material.evaluate(*moved) * moved[0][:, 2:]
    error = sent / (value * light[:, 2:]) - 1.0
    told = axis_effects(fit, arms, np.radians(0.03))
    missed = missed_effects(misfit(samples, fit), arms, np.radians(0.03))
    # all axes off by one sigma each, in whatever sense
    by_fit, by_both = (
        np.mean(np.abs(error) < Z90 * np.sqrt((each**2).sum(axis=0)))
        for each in (told, np.concatenate([told, missed]))
    )
    assert by_fit < 0.9 < by_both


def test_components_are_stored_with_names_and_units_and_add_up(photographer):
    shots = photographer(TWO, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG + STATED_TEXT)
    reduce_session(shots.calibrate().shoot().session)
    path = shots.session.samples_path
    samples = Samples.load(path)
    assert tuple(samples.components) == COMPONENT_NAMES
    total = np.sqrt(sum(part**2 for part in samples.components.values()))
    np.testing.assert_allclose(samples.sigma, total, rtol=1e-12)
    np.testing.assert_allclose(samples.components["reference"], 0.01 * samples.value)
    with xarray.open_dataset(path) as dataset:
        for component in COMPONENTS:
            stored = dataset[f"sigma_{component.name}"]
            assert stored.attrs["units"] == "sr-1"
            assert stored.attrs["correlation"].startswith("common") == component.common


def test_what_sample_and_reference_share_cancels(photographer, monkeypatch):
    # the reference itself, measured as a sample where the reference is
    glossy = AnisotropicGGX((0.9, 0.9, 0.9), 0.6, 0.6)
    for place in ("gonio.reduce.calibrate", "sim.camera"):
        monkeypatch.setattr(f"{place}.reference_material", lambda rig: glossy)
    monkeypatch.setattr("gonio.reduce.budget.smooth_fit", lambda samples: glossy)
    shots = photographer(
        [(0, 0, 45, 0)], glossy, exposures_s=(0.2,), rig_text=SMALL_RIG + STATED_TEXT
    )
    samples = reduce_session(shots.calibrate().shoot().session)
    alone = axis_effects(glossy, np.radians([[0.0, 0.0, 45.0, 0.0]]), np.radians(0.02))
    slope = np.sqrt((alone**2).sum(axis=0))
    assert (samples.components["angle"] < 0.05 * slope * samples.value).all()
    assert (samples.components["stray"] < 1e-4 * samples.value).all()
    assert (samples.components["reference"] > 0.009 * samples.value).all()


def test_files_of_before_there_were_components_are_read(tmp_path, photographer):
    shots = photographer(TWO, GREY, exposures_s=(0.2,), rig_text=SMALL_RIG).calibrate().shoot()
    samples = reduce_session(shots.session)
    unstated = ("flux", "angle", "alignment", "stray", "reference")
    assert not any(samples.components[name].any() for name in unstated)
    replace(samples, components={}).save(tmp_path / "old.nc")
    old = Samples.load(tmp_path / "old.nc")
    assert old.components == {}
    np.testing.assert_array_equal(old.sigma, samples.sigma)


@pytest.mark.parametrize(
    ("told", "exposures_s"),
    [(0.0, (0.35,)), (0.03, (0.35,)), (0.03, (0.2, 2.0))],
    ids=["left in", "taken off", "taken off beside paper that is saturated"],
)
def test_stray_light_is_taken_off_where_the_rig_file_tells_of_it(told, exposures_s):
    # 3 % of a frame with white paper in it is much beside a dark sample; 0.4 s saturates the white
    rig = small_rig(Uncertainty(), told, pixels=160, exposures_s=exposures_s)
    truly = replace(Errors.draw(rig, np.random.default_rng(0)), stray_light=0.03)
    samples, truth = drawn_samples(
        rig, Lambert((0.02, 0.02, 0.02)), np.random.default_rng(1), shots=4, errors=truly
    )
    green = ((samples.value - truth) / samples.sigma)[:, 1]
    assert (np.abs(green) < 4).all() if told else (green > 4).any()


# what is stated, the component that holds it, the sample, the sensor's side and exposures
CAUSES = {
    "reference": ({"reference": 0.05}, "reference", 0.4, 40),
    "flux": ({"flux_monitor": 0.05}, "flux", 0.4, 40),
    "angle": ({"angle_deg": 1.0}, "angle", 0.4, 40),
    "tilt": ({"tilt_deg": 1.0}, "alignment", 0.4, 40),
    "height": ({"height_mm": 5.0}, "alignment", 0.8, 40),
    "black level": ({"black_level_dn": 300.0}, "dark", 0.4, 40),
    # seen with what lies about it; of one as bright as that, stray light cancels
    "stray light": ({"stray_light": 0.05}, "stray", 0.02, 96),
    # which saturates the white, so that sample and white hang on exposures of their own
    "shutter": ({"shutter": 0.05}, "shutter", 0.1, 40, (0.2, 1.0)),
}


@pytest.mark.parametrize("cause", CAUSES.values(), ids=CAUSES)
def test_each_cause_alone_errs_as_its_component_says(cause):
    stated, component, albedo, pixels, *others = cause
    rig = small_rig(Uncertainty(**stated), 0.2, pixels=pixels, exposures_s=(*others, (0.2,))[0])
    random = np.random.default_rng(7)
    whole, without = [], []
    for _ in range(20):
        samples, truth = drawn_samples(rig, Lambert((albedo,) * 3), random, shots=3)
        square, held = (samples.value - truth) ** 2, samples.components[component] ** 2
        whole.append(np.mean(square / samples.sigma**2))
        without.append(np.mean(square / (samples.sigma**2 - held)))
    # twenty draws tell a standard deviation to a sixth
    assert 0.6 < np.sqrt(np.mean(whole)) < 1.5
    # and this is so large that nothing else holds it
    assert np.sqrt(np.mean(without)) > 1.4 * np.sqrt(np.mean(whole))


def test_intervals_hold_nine_of_ten_in_less_room_than_a_constant_sigma():
    rig, random = small_rig(STATED, exposures_s=(0.2, 2.0)), np.random.default_rng(3)
    drawn = [
        drawn_samples(rig, load_material(name), random, shots=6)
        for name in ("woven-cloth", "wood-veneer") * 6
    ]
    value, sigma, truth = (
        np.concatenate(part)
        for part in zip(*((s.value, s.sigma, truth) for s, truth in drawn), strict=True)
    )
    assert 0.8 < covered(value, sigma, truth) < 0.98
    assert interval_score(value, sigma, truth) < interval_score(
        value, constant_sigma(value, truth), truth
    )
