import json

import numpy as np
import pytest

from gonio.directions import from_degrees
from gonio.errors import BadFileError, BadInputError
from gonio.samples import Samples
from nnbrdf.analytic_model import AnalyticEstimator
from nnbrdf.estimators import ESTIMATORS, estimator_named
from nnbrdf.halfway import HALFWAY, HALFWAY_INPUTS
from nnbrdf.load import load_model
from nnbrdf.posterior_model import PriorEstimator
from nnbrdf.prior import MaterialPrior, Pairs
from nnbrdf.prior.generated import GeneratedMaterials
from nnbrdf.spectrum import as_one_channel, single_spectrum
from nnbrdf.taught import TaughtBRDF
from nnbrdf.teaching import SIZES, TaughtEstimator

PRIOR = MaterialPrior.generate(examples=150)
STEPS = 6000


def directions(seed, count, most_deg=75.0):
    rng = np.random.default_rng(seed)
    return from_degrees(rng.uniform(0, most_deg, count), rng.uniform(0, 360, count))


def samples_of(*, isotropic=True, tints=(1.0, 1.0, 1.0), count=60):
    drawn = GeneratedMaterials.draw(1, 1008, isotropic=isotropic)
    light, view = directions(1, count), directions(2, count)
    value = drawn.evaluate(Pairs.of(light, view)) * np.array(tints)
    return Samples.from_values(light, view, value, sigma=0.001 * value)


def colored(count=60):
    """Return samples whose red has a lobe that the blue lacks."""
    samples = samples_of(count=count)
    value = samples.value.copy()
    value[:, 2] = np.median(value[:, 2])
    return Samples.from_values(samples.light, samples.view, value, sigma=0.001 * value)


def estimator(**settings):
    return TaughtEstimator(**({"steps": STEPS, "prior": PRIOR} | settings))


@pytest.fixture(scope="module")
def taught():
    return estimator().fit(colored())


def test_it_says_what_the_posterior_says(taught):
    posterior = PriorEstimator(prior=PRIOR).fit(colored())
    light, view = directions(3, 500), directions(4, 500)
    off = np.log((taught.evaluate(light, view) + 0.01) / (posterior.evaluate(light, view) + 0.01))
    assert np.abs(off).mean() < 0.05
    assert taught.card.teaching_error < 0.05


def test_its_band_is_about_the_posterior_s(taught):
    posterior = PriorEstimator(prior=PRIOR).fit(colored())
    light, view = directions(3, 300), directions(4, 300)

    def width(model):
        low, high = model.quantiles(light, view)
        return np.log((high + 0.01) / (low + 0.01)).mean()

    assert 0.8 < width(taught) / width(posterior) < 1.7
    low, high = taught.quantiles(light, view)
    assert (low <= taught.evaluate(light, view)).all()
    assert (taught.evaluate(light, view) <= high).all()


def test_light_and_view_are_exchangeable_and_the_whole_may_be_turned(taught):
    assert taught.card.findings.isotropic
    light, view = directions(5, 100), directions(6, 100)
    turn = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    there = taught.evaluate(light, view)
    assert taught.evaluate(light @ turn.T, view @ turn.T) == pytest.approx(there, rel=1e-4)
    if taught.card.findings.reciprocal:
        assert taught.evaluate(view, light) == pytest.approx(there, rel=1e-4)


@pytest.mark.parametrize("name", HALFWAY)
def test_inputs_without_exchange_are_reciprocal(name):
    light, view = directions(1, 50, 90.0), directions(2, 50, 90.0)
    there, back = HALFWAY[name](light, view), HALFWAY[name](view, light)
    assert there.shape == (50, HALFWAY_INPUTS[name])
    assert np.isfinite(there).all()
    if name.endswith("-exchange"):
        assert not np.allclose(there, back)
    else:
        assert there == pytest.approx(back, abs=1e-12)
    if name.startswith("isotropic"):
        turn = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
        assert HALFWAY[name](light @ turn.T, view @ turn.T) == pytest.approx(there, abs=1e-12)


def test_opposite_directions_at_the_horizon_have_inputs():
    light, view = from_degrees([90.0], [0.0]), from_degrees([90.0], [180.0])
    for encode in HALFWAY.values():
        assert np.isfinite(encode(light, view)).all()


def test_what_the_network_misses_is_in_its_spread():
    samples = colored()
    light, view = directions(5, 300), directions(6, 300)
    hasty, patient = (estimator(steps=steps).fit(samples) for steps in (40, STEPS))
    for model, relation in ((hasty, 1.0), (patient, 0.0)):
        low, high = model.quantiles(light, view)
        floor = 0.01 * model.card.scale
        half = np.log((high + floor) / (low + floor)).mean() / 2
        # the root mean square is above the mean absolute error
        assert half > 1.645 * relation * model.card.teaching_error
    assert hasty.card.teaching_error > 5 * patient.card.teaching_error


def test_the_sigma_of_the_samples_lets_channels_differ():
    samples = samples_of(tints=(1.0, 0.5, 0.2))
    noisy = samples.value * (1 + 0.05 * np.random.default_rng(0).standard_normal((60, 3)))
    pair = (samples.light, samples.view, noisy)
    assert single_spectrum(Samples.from_values(*pair, sigma=0.001 * noisy)) is None
    assert single_spectrum(Samples.from_values(*pair, sigma=0.05 * noisy)) is not None


def test_a_single_spectrum_needs_a_single_output():
    tinted = samples_of(tints=(1.4, 1.0, 0.6))
    model = estimator().fit(tinted)
    assert model.card.findings.single_spectrum
    assert model.card.layers[-1] == 1
    value = model.evaluate(tinted.light, tinted.view)
    assert value[:, 0] / value[:, 1] == pytest.approx(1.4, rel=0.01)
    assert np.median(value / tinted.value) == pytest.approx(1.0, abs=0.02)
    sigma = model.sigma(tinted.light, tinted.view)
    assert sigma[:, 0] / sigma[:, 1] == pytest.approx(1.4, rel=0.01)


def test_different_spectra_keep_their_outputs(taught):
    assert not taught.card.findings.single_spectrum
    assert taught.card.layers[-1] == 3


@pytest.mark.parametrize("size", SIZES)
def test_sizes_are_kept(size):
    model = estimator(size=size, steps=100).fit(colored(20))
    assert 0.9 * int(size) < model.card.weights <= int(size)


def test_the_same_seed_gives_the_same_bytes(tmp_path):
    for name in ("a", "b"):
        estimator(steps=300).fit(colored(20)).save(tmp_path / name)
    for name in ("weights.safetensors", "model.json", "grid.npz"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    estimator(steps=300, seed=1).fit(colored(20)).save(tmp_path / "c")
    assert (tmp_path / "a" / name).read_bytes() != (tmp_path / "c" / name).read_bytes()


QUICK = {
    "nn": estimator(steps=300),
    "prior": PriorEstimator(prior=PRIOR),
    "analytic": AnalyticEstimator(),
    "paper": estimator_named("paper")(steps=50, members=2),
}
assert set(QUICK) == set(ESTIMATORS)


@pytest.mark.parametrize("name", QUICK)
def test_a_model_loads_as_it_was_saved(name, tmp_path):
    samples = colored(30)
    model = QUICK[name].fit(samples)
    model.save(tmp_path / "model")
    again = load_model(tmp_path / "model")
    light, view = directions(7, 40), directions(8, 40)
    assert again.card == model.card
    assert again.evaluate(light, view) == pytest.approx(model.evaluate(light, view), rel=1e-9)
    assert again.sigma(light, view) == pytest.approx(model.sigma(light, view), rel=1e-6)
    for told, mine in zip(again.quantiles(light, view), model.quantiles(light, view), strict=True):
        assert told == pytest.approx(mine, rel=1e-6)
    grid = np.load(tmp_path / "model" / "grid.npz")
    assert {name: grid[name].shape for name in grid} == dict.fromkeys(
        ("values", "sigma", "lo", "hi"), (81, 81, 3)
    )
    assert again.card.sentences()
    # one direction against many, and a single pair
    assert again.evaluate(light[0], view).shape == (40, 3)
    assert again.evaluate(light[0], view[0]) == pytest.approx(model.evaluate(light, view)[0])


@pytest.mark.parametrize("name", QUICK)
def test_too_few_samples_are_refused(name):
    with pytest.raises(BadInputError, match="at least 8"):
        QUICK[name].fit(colored(7))


@pytest.mark.parametrize("name", QUICK)
def test_one_channel_is_enough(name):
    samples = colored(30)
    one = Samples.from_values(samples.light, samples.view, samples.value[:, :1], channels=("y",))
    value = QUICK[name].fit(one).evaluate(samples.light, samples.view)
    assert value.shape == (30, 3)
    assert (value[:, 0] == value[:, 2]).all()


def changed(folder, **fields):
    path = folder / "model.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | fields))


BROKEN = [
    ("encoding", {"encoding": "xyz"}, "encoding: must be one of"),
    ("layers", {"layers": [6, 4, 3]}, "layers"),
    ("tint", {"tint": [1.0]}, "a tint each"),
    ("weights", {"weights": 5}, "weights: layers make"),
    ("schema", {"schema": "gonio.taught/9"}, "has schema"),
]


@pytest.mark.parametrize(("fields", "says"), [b[1:] for b in BROKEN], ids=[b[0] for b in BROKEN])
def test_a_card_that_does_not_fit_is_refused(fields, says, tmp_path):
    estimator(steps=50).fit(colored(20)).save(tmp_path / "model")
    changed(tmp_path / "model", **fields)
    with pytest.raises(BadFileError, match=says):
        load_model(tmp_path / "model")


def test_weights_that_are_missing_are_refused(tmp_path):
    estimator(steps=50).fit(colored(20)).save(tmp_path / "model")
    (tmp_path / "model" / "weights.safetensors").write_bytes(b"nothing")
    with pytest.raises(BadFileError, match="is broken"):
        load_model(tmp_path / "model")


@pytest.mark.parametrize(
    ("settings", "says"),
    [({"size": "7"}, "size '7' is not known"), ({"steps": 0}, "at least 1"),
     ({"activation": "best"}, "best")],
)  # fmt: skip
def test_bad_settings(settings, says):
    with pytest.raises(BadInputError, match=says):
        estimator(**settings)


def test_an_activation_that_overflows_says_so():
    with pytest.raises(BadInputError, match="overflowed"):
        estimator(activation="exponential", steps=3000).fit(
            samples_of(tints=(1e3, 1.0, 1e-3), count=20)
        )


def test_progress_ends_at_the_whole():
    seen = []
    estimator(steps=100).fit(colored(20), lambda done, total: seen.append((done, total)))
    assert seen[-1] == (100, 100)
    assert seen == sorted(seen)


def test_what_was_loaded_is_a_taught_network(tmp_path, taught):
    taught.save(tmp_path / "model")
    assert isinstance(load_model(tmp_path / "model"), TaughtBRDF)


def matte(count=40):
    light, view = directions(1, count), directions(2, count)
    value = np.array([0.5, 0.3, 0.2]) / np.pi * (1 + 0.1 * light[:, :1] * view[:, 1:2])
    return Samples.from_values(light, view, value, sigma=0.02 * value)


def test_a_matte_material_needs_fewer_weights():
    model = estimator(steps=20_000).fit(matte())
    assert model.card.left_small
    assert model.card.weights <= 88
    assert any("so few weights" in sentence for sentence in model.card.sentences())


def test_nothing_is_left_out_when_told_so():
    model = estimator(general=True, steps=500).fit(samples_of(count=30))
    assert model.card.encoding == "anisotropic-exchange"
    assert model.card.layers[-1] == 3
    assert not model.card.left_small
    assert model.card.weights > 1200


def test_what_was_not_asked_is_not_claimed():
    model = estimator(general=True, steps=300).fit(samples_of(count=30))
    said = " ".join(model.card.sentences())
    assert "isotropy was not examined" in said
    assert "reciprocity was not examined" in said
    assert "spectrum" not in said
    assert "channels" not in said


def test_a_dark_channel_does_not_spoil_the_bright_one():
    rng = np.random.default_rng(0)
    samples = samples_of(tints=(1.0, 0.4, 0.004), count=80)
    noise = np.array([1e-4, 1e-4, 2e-3]) * samples.white
    value = samples.value + noise * rng.standard_normal(samples.value.shape)
    noisy = Samples.from_values(samples.light, samples.view, value, sigma=value * 0 + noise)
    factor = single_spectrum(noisy)
    assert factor is not None
    merged = as_one_channel(noisy, factor)
    off = merged.value[:, 0] * factor[0] / samples.value[:, 0] - 1
    assert np.median(np.abs(off)) < 0.01
    expected = merged.sigma[:, 0] * factor[0] / samples.value[:, 0]
    assert 0.3 < np.median(np.abs(off)) / np.median(expected) < 3


def test_a_matte_material_s_progress_ends_as_well():
    seen = []
    estimator(steps=20_000).fit(matte(), lambda done, total: seen.append((done, total)))
    assert seen[-1] == (20_000, 20_000)
