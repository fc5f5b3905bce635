"""Fitting: what made the samples is found again, and bad samples are refused or survived."""

from dataclasses import replace
from threading import Thread
from time import perf_counter

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from gonio.directions import from_degrees, paper_directions
from gonio.errors import BadInputError
from gonio.materials import MeasuredTable
from gonio.samples import Samples
from nnbrdf.fitting import MODELS, fit_model
from nnbrdf.metrics import male
from nnbrdf.timing import million_seconds

each = pytest.mark.parametrize("name", MODELS)
COLORS = np.array([[0.3, 0.2, 0.1], [0.4, 0.35, 0.3], [0.1, 0.1, 0.2]])


def some_pairs(count, seed=0):
    rng = np.random.default_rng(seed)
    theta, phi = rng.uniform(0, 75, (2, count)), rng.uniform(0, 360, (2, count))
    return from_degrees(theta[0], phi[0]), from_degrees(theta[1], phi[1])


def a_material(name):
    family = MODELS[name]
    places = {"metalness": 0.3, "C_x": 0.1, "C_y": 0.15, "C_z": 0.8, "phi": 0.3, "sigma": 0.7}
    places |= {"alpha_x": 0.4, "second_alpha_x": 0.8, "second_alpha_y": 0.9, "f0": 0.2}
    shape = [each.at(places.get(each.name, 0.6)) for each in family.shape]
    return family.material(np.array(shape), COLORS[: len(family.terms)])


@each
def test_what_made_the_samples_is_found_again(name):
    material = a_material(name)
    light, view = some_pairs(300)
    fit = fit_model(name, Samples.from_values(light, view, material.evaluate(light, view)))
    light, view = some_pairs(5000, seed=1)
    truth, found = material.evaluate(light, view), fit.material.evaluate(light, view)
    assert (abs(found - truth) / truth).max() < 0.01
    assert fit.residual < 1e-4
    assert fit.converged
    assert list(fit.shape) == [each.name for each in MODELS[name].shape]
    assert fit.seconds > 0
    assert fit.evaluations > 0


@each
def test_any_shape_of_the_box_is_found_again(name):
    family, rng = MODELS[name], np.random.default_rng(4)
    for trial in range(3):
        shape = [each.at(rng.uniform(0.15, 0.9)) for each in family.shape]
        material = family.material(np.array(shape), rng.uniform(0.05, 0.6, (len(family.terms), 3)))
        light, view = some_pairs(196, seed=trial)
        fit = fit_model(name, Samples.from_values(light, view, material.evaluate(light, view)))
        light, view = some_pairs(2000, seed=100 + trial)
        truth, found = material.evaluate(light, view), fit.material.evaluate(light, view)
        assert (abs(found - truth) / truth).max() < 0.01, shape


def test_gross_outliers_do_not_move_it():
    material = a_material("ggx")
    light, view = some_pairs(200)
    values = material.evaluate(light, view)
    values[:5] *= 100
    fit = fit_model("ggx", Samples.from_values(light, view, values))
    truth = material.evaluate(*some_pairs(500, seed=1))
    found = fit.material.evaluate(*some_pairs(500, seed=1))
    assert np.median(abs(found - truth) / truth) < 0.03


def test_the_same_seed_gives_the_same_fit():
    light, view = some_pairs(700)
    samples = Samples.from_values(light, view, a_material("ggx").evaluate(light, view))
    first, second = (fit_model("ward", samples, seed=3) for _ in range(2))
    assert first.shape == second.shape
    assert np.array_equal(first.colors, second.colors)


EXTREMES = {
    "zeros among them": lambda values: values * (np.arange(len(values)) % 2)[:, None],
    "constant": np.ones_like,
    "bright": lambda values: values * 1e4,
    "dark": lambda values: values * 1e-6,
    "below zero": lambda values: values - 0.02,
    "one channel": lambda values: values[:, :1],
}


@pytest.mark.parametrize("change", EXTREMES.values(), ids=EXTREMES)
@pytest.mark.parametrize("name", ["ggx-two-lobes", "lafortune", "strauss", "oren-nayar"])
def test_extreme_samples(name, change):
    light, view = some_pairs(60)
    values = change(a_material("ggx").evaluate(light, view))
    fit = fit_model(name, Samples.from_values(light, view, values, **channels_of(values)))
    grid = paper_directions()
    found = fit.material.evaluate(grid[:, None], grid[None])
    assert np.isfinite(found).all()
    assert (found >= 0).all()


def channels_of(values):
    return {"channels": ("y",)} if values.shape[1] == 1 else {}


@each
def test_all_at_one_pair_of_directions(name):
    one = np.tile(from_degrees(30, 40), (20, 1))
    fit = fit_model(name, Samples.from_values(one, one, np.full((20, 3), 0.2)))
    assert np.allclose(fit.material.evaluate(one[0], one[0]), 0.2, rtol=0.05)


def test_one_channel_says_the_same_in_all_three():
    light, view = some_pairs(60)
    values = a_material("ggx").evaluate(light, view)[:, :1]
    fit = fit_model("ggx", Samples.from_values(light, view, values, channels=("y",)))
    found = fit.material.evaluate(light, view)
    assert np.allclose(found, values, rtol=1e-3)


def test_a_solver_out_of_steps_says_so(monkeypatch):
    monkeypatch.setattr("nnbrdf.fitting.fit._STEPS", 2)
    light, view = some_pairs(60)
    values = a_material("ggx").evaluate(light, view)
    assert not fit_model("ggx", Samples.from_values(light, view, values)).converged


def fit_beside(monkeypatch, while_evaluating):
    """Fit `lambert`, and do something else whenever it is evaluated."""
    family = MODELS["lambert"]

    def evaluate(pairs, shape):
        while_evaluating()
        return family.evaluate(pairs, shape)

    monkeypatch.setitem(MODELS, "lambert", replace(family, evaluate=evaluate))
    light, view = some_pairs(60)
    return fit_model("lambert", Samples.from_values(light, view, np.full((60, 3), 0.2)))


def test_the_time_of_a_fit_is_the_time_of_its_own_thread(monkeypatch):
    spent = []

    def work_elsewhere():
        began = perf_counter()
        thread = Thread(target=lambda: sum(range(1_000_000)))
        thread.start()
        thread.join()
        spent.append(perf_counter() - began)

    fit = fit_beside(monkeypatch, work_elsewhere)
    assert fit.evaluations > 1
    # the residual, told at the end, is evaluated after the clock has stopped
    assert 0 < fit.seconds < 0.5 * sum(spent[: fit.evaluations])


def test_a_fit_takes_one_core(monkeypatch):
    threads = []
    with threadpool_limits(2, "blas"):
        fit_beside(monkeypatch, lambda: threads.extend(blas_threads()))
        # what was allowed before is so after
        assert set(blas_threads()) == {2}
    assert set(threads) == {1}


def test_a_million_pairs_take_one_core():
    threads = []
    with threadpool_limits(2, "blas"):
        million_seconds(lambda light, view: threads.extend(blas_threads()))
        assert set(blas_threads()) == {2}
    assert set(threads) == {1}


def blas_threads():
    """Return how many threads each library of linear algebra has."""
    return [each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"]


def test_fewer_values_than_parameters():
    light, view = some_pairs(3)
    with pytest.raises(BadInputError, match="9 values; model ggx-two-lobes has 15 parameters"):
        fit_model("ggx-two-lobes", Samples.from_values(light, view, np.ones((3, 3))))


REFUSED = {
    "black": (lambda values: 0 * values, ("r", "g", "b"), "median is 0 1/sr"),
    "two channels": (lambda values: values[:, :2], ("u", "v"), "have 2 channels; a model"),
    "none": (lambda values: values[:0], ("r", "g", "b"), "there are no samples"),
}


@pytest.mark.parametrize(("change", "channels", "message"), REFUSED.values(), ids=REFUSED)
def test_samples_that_no_model_fits(change, channels, message):
    light, view = some_pairs(20)
    values = change(a_material("ggx").evaluate(light, view))
    count = len(values)
    samples = Samples.from_values(light[:count], view[:count], values, channels=channels)
    with pytest.raises(BadInputError, match=message):
        fit_model("ggx", samples)


def test_values_that_are_not_finite():
    light, view = some_pairs(20)
    values = np.ones((20, 3))
    values[3] = np.nan
    with pytest.raises(BadInputError):
        fit_model("ggx", Samples.from_values(light, view, values))


MEASURED = [
    ("rgl_satin_rosaline", "lambert", 0.204),
    ("rgl_satin_rosaline", "ggx", 0.112),
    ("rgl_satin_rosaline", "ggx-two-lobes", 0.108),
    ("ubo2014_felt05", "lambert", 0.332),
    ("ubo2014_felt05", "ggx", 0.114),
    ("ubo2014_felt05", "schlick", 0.131),
]


@pytest.mark.measured
@pytest.mark.parametrize(("material", "name", "expected"), MEASURED)
def test_measured_materials(measured, material, name, expected):
    table = MeasuredTable.load(measured / f"{material}.npz")
    grid = paper_directions()
    light, view = np.repeat(grid, 81, axis=0), np.tile(grid, (81, 1))
    fit = fit_model(name, Samples.from_values(light, view, table.values.reshape(-1, 3)))
    found = fit.material.evaluate(grid[:, None], grid[None])
    assert male(found, table.values, table.white) == pytest.approx(expected, abs=0.002)
    assert fit.converged
