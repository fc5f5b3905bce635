import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from gonio.directions import paper_directions
from gonio.errors import BadInputError
from gonio.materials import MeasuredTable
from gonio.samples import Flag, Samples
from nnbrdf.estimators import ESTIMATORS, estimator_named
from nnbrdf.history import History
from nnbrdf.metrics import eps8, male
from nnbrdf.model import NNBRDF
from nnbrdf.paper import PaperEstimator

QUICK = {"hidden": (3, 6, 4), "steps": 30}


def velvet(light, view):
    """A smooth tinted material, brighter towards grazing light and view."""
    return np.array([0.2, 0.1, 0.05]) / (0.3 + light[..., 2:] * view[..., 2:])


def some_samples(count=60, channels=("r", "g", "b")):
    rng = np.random.default_rng(3)
    directions = paper_directions()
    light, view = directions[rng.integers(81, size=(2, count))]
    value = velvet(light, view)[:, : len(channels)]
    samples = Samples.from_values(light, view, value, channels=channels)
    return replace(samples, provenance={"table": "ab" * 32})


def test_learns_a_material_from_samples():
    directions = paper_directions()
    true = velvet(directions[:, None], directions[None])
    white = MeasuredTable.of(true).white
    model = PaperEstimator(steps=1500).fit(some_samples(200))
    grid = model.grid()
    flat = np.broadcast_to(np.median(true, axis=(0, 1)), true.shape)
    assert eps8(grid["values"], true, white) < 0.4 * eps8(flat, true, white)
    assert male(grid["values"], true, white) < 0.4 * male(flat, true, white)


def test_the_card_says_what_was_done():
    samples = some_samples()
    card = PaperEstimator(**QUICK, seed=3).fit(samples).card
    assert (card.estimator, card.encoding, card.activation) == ("paper", "xyz", "softsign")
    assert card.layers == (6, 3, 6, 4, 3)
    assert card.weights == 88
    assert card.white == samples.white == 4 * np.median(samples.value)
    assert (card.samples, card.steps, card.seed) == (60, 30, 3)
    assert card.channels == ("r", "g", "b")
    assert card.color_space == "linear sRGB"
    assert card.provenance == {"table": "ab" * 32}


def test_the_member_with_the_median_loss_is_delivered():
    model = PaperEstimator(**QUICK).fit(some_samples())
    losses = model.card.final_losses
    assert losses[model.card.delivered] == np.median(losses)
    assert np.ptp(losses) > 0
    assert list(losses) == model.history.checkpoints[-1].loss.tolist()


def test_epochs_keep_the_last_partial_batch():
    model = PaperEstimator(hidden=(2,), epochs=7).fit(some_samples(33))
    assert model.card.steps == 14
    assert PaperEstimator(hidden=(2,), epochs=7, steps=5).fit(some_samples(33)).card.steps == 5


def test_one_channel_trains_one_output():
    model = PaperEstimator(**QUICK).fit(some_samples(channels=("y",)))
    assert model.card.layers == (6, 3, 6, 4, 1)
    assert model.grid()["values"].shape == (81, 81, 3)


def test_the_same_samples_give_the_same_bytes(tmp_path):
    for folder, seed in (("a", 0), ("b", 0), ("c", 1)):
        PaperEstimator(**QUICK, seed=seed).fit(some_samples()).save(tmp_path / folder)

    def read(folder, name):
        return (tmp_path / folder / name).read_bytes()

    for name in ("weights.safetensors", "model.json", "grid.npz"):
        assert read("a", name) == read("b", name)
        assert read("a", name) != read("c", name)


def test_the_history_lies_beside_the_model_and_ends_as_it(tmp_path):
    model = PaperEstimator(**QUICK).fit(some_samples())
    model.save(tmp_path)
    history, loaded = History.load(tmp_path), NNBRDF.load(tmp_path)
    grids = history.grids(-1)
    assert grids.shape == (5, 81, 81, 3)
    assert np.allclose(grids[model.card.delivered], loaded.grid()["values"], rtol=1e-6)
    assert [point.step for point in history.checkpoints][-1] == 30


def test_values_above_white_and_below_zero_count_as_the_ends():
    samples = some_samples()
    inside = np.clip(samples.value, 0.06, samples.white)
    beyond = np.where(inside >= samples.white, 50.0, inside)
    beyond[0], inside[0] = -0.01, 0.0
    beyond[1], inside[1] = 60.0, samples.white
    first, second = (
        PaperEstimator(**QUICK).fit(replace(samples, value=value)) for value in (inside, beyond)
    )
    assert first.card == second.card


def test_clipped_samples_are_kept():
    samples = some_samples()
    flagged = replace(samples, flag=samples.flag | np.uint32(Flag.CLIPPED))
    fits = [PaperEstimator(**QUICK).fit(each).card for each in (samples, flagged)]
    assert fits[0] == fits[1]


def test_progress_is_told():
    calls = []
    PaperEstimator(**QUICK).fit(some_samples(), lambda done, total: calls.append((done, total)))
    assert calls[-1] == (30, 30)


def broken(**changes):
    return lambda: replace(some_samples(), **changes)


NAN = np.full((60, 3), np.nan)
BAD = {
    "too few": (lambda: some_samples(7), "there are 7 samples; estimator paper takes at least 8"),
    "one": (lambda: some_samples(1), "there is 1 sample; estimator paper takes at least 8"),
    "none": (lambda: some_samples(0), "there are 0 samples"),
    "NaN": (broken(value=NAN), "row 0: value is not finite"),
    "negative sigma": (broken(sigma=-np.ones((60, 3))), "row 0: sigma is negative"),
    "two channels": (lambda: some_samples(channels=("a", "b")), "have 2 channels"),
    "no light": (broken(value=np.zeros((60, 3))), "median is 0 1/sr"),
}


@pytest.mark.parametrize(("make", "problem"), BAD.values(), ids=BAD)
def test_refuses_samples_that_teach_nothing(make, problem):
    with pytest.raises(BadInputError, match=problem) as caught:
        PaperEstimator().fit(make())
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "settings",
    [{"epochs": 0}, {"steps": 0}, {"seed": -1}, {"members": 1}, {"hidden": (15, 0)}],
    ids=str,
)
def test_refuses_settings_that_train_nothing(settings):
    with pytest.raises(BadInputError, match=next(iter(settings))):
        PaperEstimator(**settings)


def test_estimators_by_name():
    assert estimator_named("paper")(seed=2) == PaperEstimator(seed=2)
    assert [make().name for make in ESTIMATORS.values()] == list(ESTIMATORS)
    with pytest.raises(BadInputError, match="'best' is not known; use nn, prior"):
        estimator_named("best")


def test_with_neither_kernel_nor_torch_it_says_what_to_install():
    code = (
        "import sys; sys.modules['torch'] = sys.modules['nnbrdf._fused'] = None\n"
        "import numpy as np\n"
        "from gonio.samples import Samples\n"
        "from nnbrdf.paper import PaperEstimator\n"
        "up = np.tile([0.0, 0.0, 1.0], (8, 1))\n"
        "try: PaperEstimator().fit(Samples.from_values(up, up, np.ones((8, 3))))\n"
        "except Exception as error: print(type(error).__name__, error)"
    )
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    ran = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False
    )
    assert ran.stdout.startswith("MissingExtraError this needs torch")
    assert "gonio[nn]" in ran.stdout


def farthest(count):
    """Directions spread greedily from the pole; ties to the lowest index."""
    directions = paper_directions()
    chosen = [0]
    while len(chosen) < count:
        nearest = (directions @ directions[chosen].T).max(axis=1)
        chosen.append(int(np.argmin(nearest.round(9))))
    return np.sort(chosen)


# medians of 41 members, with the samples' own white; medians of five scatter within the band
MEASURED = [("rgl_satin_rosaline", 9.5, 0.140, 0.6), ("ubo2014_felt05", 10.2, 0.140, 0.8)]


@pytest.mark.measured
@pytest.mark.parametrize(("name", "expected_eps8", "expected_male", "band"), MEASURED, ids=str)
def test_scores_on_a_measured_material(measured, name, expected_eps8, expected_male, band):
    table = MeasuredTable.load(measured / f"{name}.npz")
    few, directions = farthest(14), paper_directions()
    light, view = np.repeat(directions[few], 14, axis=0), np.tile(directions[few], (14, 1))
    samples = Samples.from_values(light, view, table.values[np.ix_(few, few)].reshape(-1, 3))
    history = PaperEstimator().fit(samples).history
    grids = history.grids(-1)
    errors = [eps8(grid, table.values, table.white) for grid in grids]
    logs = [male(grid, table.values, table.white) for grid in grids]
    assert len(samples) == 196
    assert history.checkpoints[-1].step == 3500
    assert np.median(errors) == pytest.approx(expected_eps8, abs=band)
    assert np.median(logs) == pytest.approx(expected_male, abs=0.02)


@pytest.mark.parametrize(("activation", "encoding"), [("gelu", "sincos"), ("relu", "spherical")])
def test_activation_and_encoding_by_name(activation, encoding):
    samples = some_samples()
    recipe = PaperEstimator(steps=20, activation=activation, encoding=encoding)
    model = recipe.fit(samples)
    assert (model.card.activation, model.card.encoding) == (activation, encoding)
    assert model.networks.activation == activation
    assert np.isfinite(model.evaluate(samples.light, samples.view)).all()


@pytest.mark.parametrize(
    ("setting", "message"),
    [({"activation": "silu"}, "use linear, sigmoid"), ({"encoding": "abc"}, "xyz")],
)
def test_an_unknown_name_lists_the_known(setting, message):
    with pytest.raises(BadInputError, match=message):
        PaperEstimator(**setting)
