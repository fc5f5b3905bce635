import json
import os
import subprocess
import sys

import numpy as np
import pytest
import safetensors.numpy
from scipy import stats

from gonio.directions import from_degrees, paper_directions
from gonio.errors import BadFileError, StorageError
from nnbrdf.card import Card
from nnbrdf.history import FILE_NAME, Checkpoint, History
from nnbrdf.model import NNBRDF
from nnbrdf.network import glorot_uniform, weight_count

THREE = ("grid.npz", "model.json", "weights.safetensors")


def a_model(channels=("r", "g", "b"), seed=0, delivered=1, history=False):
    rngs = [np.random.default_rng(each) for each in np.random.SeedSequence(seed).spawn(5)]
    layers = (6, 8, len(channels))
    networks = glorot_uniform(layers, rngs)
    networks.layers[-1][..., -1] = 0.5
    card = Card(
        estimator="paper",
        encoding="xyz",
        layers=layers,
        activation="softsign",
        white=0.7,
        delivered=delivered,
        final_losses=(0.5, 0.3, 0.1, 0.2, 0.4),
        channels=channels,
        color_space="linear sRGB",
        weights=weight_count(layers),
        samples=196,
        steps=10,
        seed=seed,
        trainer="fused",
        diverged=0,
        provenance={"table": "ab" * 32},
    )
    none = np.zeros(5, bool)
    points = (Checkpoint(10, 0.1, np.array(card.final_losses), networks, none),)
    return NNBRDF(card, networks, History(points, "xyz", 0.7) if history else None)


def random_pairs(count):
    rng = np.random.default_rng(4)
    theta, phi = rng.uniform(0, 90, (2, count)), rng.uniform(0, 360, (2, count))
    return from_degrees(theta[0], phi[0]), from_degrees(theta[1], phi[1])


def predictions(model, light, view):
    inputs = np.concatenate([view, light], axis=-1)
    return model.card.white * model.networks.forward(inputs)


def test_value_sigma_and_quantiles_are_those_of_the_members():
    model = a_model()
    light, view = random_pairs(300)
    said = predictions(model, light, view)
    value, sigma = model.evaluate(light, view), model.sigma(light, view)
    lo, hi = model.quantiles(light, view)
    assert np.allclose(value, said[1].clip(0))
    assert np.allclose(sigma, said.std(axis=0, ddof=1))
    reach = stats.t(4).ppf(0.95) * sigma
    assert np.allclose(lo, (value - reach).clip(0))
    assert np.allclose(hi, value + reach)
    assert (said[1] < 0).any()
    assert (sigma > 0).all()
    assert ((lo <= value) & (value <= hi) & (lo >= 0)).all()


def test_directions_are_broadcast():
    model = a_model()
    light, view = random_pairs(4)
    table = model.evaluate(light[:, None], view[None])
    assert table.shape == (4, 4, 3)
    assert table.dtype == np.float64
    assert np.allclose(table[1, 3], model.evaluate(light[1], view[3]))
    assert model.evaluate(light[1], view[3]).shape == (3,)
    assert model.sigma(light[:0], view[:0]).shape == (0, 3)


def test_many_pairs_are_evaluated_piece_by_piece():
    model = a_model()
    light, view = random_pairs(40_000)
    pieces = [model.evaluate(light[i : i + 999], view[i : i + 999]) for i in range(0, 40_000, 999)]
    assert np.allclose(model.evaluate(light, view), np.concatenate(pieces), rtol=1e-12)


def test_one_channel_is_repeated():
    model = a_model(channels=("y",))
    light, view = random_pairs(5)
    value = model.evaluate(light, view)
    assert value.shape == (5, 3)
    assert np.array_equal(value[:, 0], value[:, 2])


def test_comes_back_whole(tmp_path):
    model = a_model()
    model.save(tmp_path / "model")
    loaded = NNBRDF.load(tmp_path / "model")
    light, view = random_pairs(50)
    assert loaded.card == model.card
    assert np.array_equal(loaded.evaluate(light, view), model.evaluate(light, view))
    assert np.array_equal(loaded.sigma(light, view), model.sigma(light, view))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["model"]
    assert sorted(path.name for path in (tmp_path / "model").iterdir()) == list(THREE)


def test_the_grid_is_what_the_model_says(tmp_path):
    model = a_model()
    model.save(tmp_path)
    with np.load(tmp_path / "grid.npz", allow_pickle=False) as arrays:
        grid = dict(arrays)
    directions = paper_directions()
    lo, hi = model.quantiles(directions[50], directions[7])
    said = {
        "values": model.evaluate(directions[50], directions[7]),
        "sigma": model.sigma(directions[50], directions[7]),
        "lo": lo,
        "hi": hi,
    }
    assert set(grid) == set(said)
    for name, expected in said.items():
        assert grid[name].shape == (81, 81, 3)
        assert np.allclose(grid[name][50, 7], expected, rtol=1e-6)


def test_the_same_model_gives_the_same_bytes(tmp_path):
    for name in "ab":
        a_model(history=True).save(tmp_path / name)
    for file in THREE:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_an_older_model_is_replaced_and_other_files_stay(tmp_path):
    a_model(seed=1, history=True).save(tmp_path)
    assert (tmp_path / FILE_NAME).exists()
    (tmp_path / "notes.txt").write_text("mine")
    a_model(seed=2).save(tmp_path)
    assert NNBRDF.load(tmp_path).card.seed == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*THREE, "notes.txt"])


def test_the_current_folder_works_too(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    a_model().save(".")
    assert NNBRDF.load(".").card.seed == 0


def test_what_was_left_aside_by_a_crash_does_not_get_in(tmp_path):
    (tmp_path / ".model.part").mkdir()
    (tmp_path / ".model.part" / FILE_NAME).write_bytes(b"old")
    a_model().save(tmp_path / "model")
    assert not (tmp_path / "model" / FILE_NAME).exists()


def test_an_older_model_survives_a_failure(tmp_path, monkeypatch):
    folder = tmp_path / "model"
    a_model(seed=1, history=True).save(folder)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}

    def full(*_args, **_arrays):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(StorageError, match="the disk is full"):
        a_model(seed=2).save(folder)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["model"]


def test_a_file_in_the_way(tmp_path):
    (tmp_path / "model").write_text("")
    with pytest.raises(StorageError, match="cannot be written"):
        a_model().save(tmp_path / "model")


def card_with(**changes):
    def change(folder):
        path = folder / "model.json"
        path.write_text(json.dumps(json.loads(path.read_text()) | changes))

    return change


def weights_with(**changes):
    def change(folder):
        path = folder / "weights.safetensors"
        tensors = safetensors.numpy.load(path.read_bytes()) | changes
        path.write_bytes(
            safetensors.numpy.save({k: v for k, v in tensors.items() if v is not None})
        )

    return change


def cut(folder):
    path = folder / "weights.safetensors"
    path.write_bytes(path.read_bytes()[:-100])


NAN = np.full((5, 8, 7), np.nan, np.float32)
BAD = {
    "no card": (lambda f: (f / "model.json").unlink(), "is not a model"),
    "card is no JSON": (lambda f: (f / "model.json").write_text("{"), "model.json: is not JSON"),
    "card is a list": (lambda f: (f / "model.json").write_text("[]"), "schema None"),
    "another version": (card_with(schema="gonio.model/2"), "schema 'gonio.model/2', not 'gonio.mo"),
    "a key is wrong": (card_with(white=-1), "model.json: white: "),
    "a key is unknown": (card_with(color="red"), "color: is not a known key"),
    "an encoding is unknown": (card_with(encoding="abc"), "encoding: must be one of "),
    "an activation is unknown": (card_with(activation="abc"), "activation: must be one of "),
    "no such member": (card_with(delivered=5), "there is no such member"),
    "channels do not fit": (card_with(channels=["y"]), "layers: does not begin"),
    "weights do not fit": (card_with(weights=7), "weights: layers make 83"),
    "no weights": (lambda f: (f / "weights.safetensors").unlink(), "weights.safetensors: cannot"),
    "truncated weights": (cut, "weights.safetensors: is broken"),
    "foreign weights": (lambda f: (f / "weights.safetensors").write_bytes(b"hi"), "is broken"),
    "missing layer": (weights_with(layer_1=None), "layer_1: is missing"),
    "other shape": (
        weights_with(layer_0=NAN[:4]),
        "layer_0: is float32 of shape \\(4, 8, 7\\), not",
    ),
    "other type": (weights_with(layer_0=NAN.astype(float)), "layer_0: is float64"),
    "not finite": (weights_with(layer_0=NAN), "layer_0: holds numbers that are not finite"),
}


@pytest.mark.parametrize(("change", "problem"), BAD.values(), ids=BAD)
def test_says_in_one_line_what_is_wrong(tmp_path, change, problem):
    a_model().save(tmp_path)
    change(tmp_path)
    with pytest.raises(BadFileError, match=problem) as caught:
        NNBRDF.load(tmp_path)
    assert str(caught.value).startswith(str(tmp_path))
    assert "\n" not in str(caught.value)


def test_a_model_is_used_without_torch(tmp_path):
    a_model().save(tmp_path)
    code = (
        "import sys; sys.modules['torch'] = None\n"
        "from nnbrdf.model import NNBRDF\n"
        "from gonio.directions import from_degrees as d\n"
        f"print(NNBRDF.load({str(tmp_path)!r}).sigma(d(0, 0), d(45, 0)).shape)"
    )
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    ran = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False
    )
    assert (ran.stdout, ran.stderr) == ("(3,)\n", "")
