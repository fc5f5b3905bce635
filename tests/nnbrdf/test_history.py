import numpy as np
import pytest

from gonio.directions import paper_directions
from gonio.errors import BadFileError
from nnbrdf.history import FILE_NAME, Checkpoint, History
from nnbrdf.network import glorot_uniform


def a_history(channels=3):
    rngs = [np.random.default_rng(seed) for seed in range(2)]
    points = [
        Checkpoint(
            step,
            0.1 * step,
            np.array([0.5, 0.4]) / step,
            glorot_uniform((6, 4, channels), rngs, activation="tanh"),
            np.array([False, step > 10]),
        )
        for step in (1, 10, 100)
    ]
    return History(tuple(points), "xyz", 0.8)


def test_comes_back_whole(tmp_path):
    history = a_history()
    history.save(tmp_path)
    loaded = History.load(tmp_path)
    assert (loaded.encoding, loaded.white, len(loaded)) == ("xyz", 0.8, 3)
    for a, b in zip(loaded.checkpoints, history.checkpoints, strict=True):
        assert (a.step, a.seconds, a.loss.tolist()) == (b.step, b.seconds, b.loss.tolist())
        assert a.diverged.tolist() == b.diverged.tolist()
        assert a.networks.activation == "tanh"
        for x, y in zip(a.networks.layers, b.networks.layers, strict=True):
            assert np.array_equal(x, y)
            assert x.dtype == np.float32


def test_grids_are_what_each_member_said(tmp_path):
    history = a_history()
    grids = history.grids(1)
    directions = paper_directions()
    assert grids.shape == (2, 81, 81, 3)
    assert grids.min() == 0
    inputs = np.concatenate([directions[7], directions[50]])[None]  # view, then light
    said = 0.8 * history.checkpoints[1].networks.forward(inputs)[:, 0]
    assert np.allclose(grids[:, 50, 7], said.clip(0))


def test_one_channel_is_repeated():
    grids = a_history(channels=1).grids(-1)
    assert grids.shape == (2, 81, 81, 3)
    assert np.array_equal(grids[..., 0], grids[..., 2])


def without(name, **others):
    def change(path):
        with np.load(path) as arrays:
            kept = {key: value for key, value in arrays.items() if key != name}
        np.savez(path, **(kept | others))

    return change


BAD = {
    "missing": (lambda path: path.unlink(), "no such file"),
    "truncated": (lambda path: path.write_bytes(path.read_bytes()[:3000]), "is not a training"),
    "foreign": (lambda path: path.write_text("hello"), "is not a training history"),
    "another schema": (without("schema", schema="gonio.history/9"), "schema 'gonio.history/9'"),
    "another activation": (without("activation", activation="abc"), "activation 'abc'"),
    "another encoding": (without("encoding", encoding="abc"), "encoding 'abc'"),
    "no loss": (without("loss"), "loss: is missing"),
    "layers that do not follow": (without("layer_1", layer_1=np.ones((3, 2, 3, 9))), "do not fit"),
    "fewer losses": (without("loss", loss=np.ones((2, 2))), "is not a training history"),
    "pickled": (without("loss", loss=np.array([{}])), "is not a training history"),
}


@pytest.mark.parametrize(("change", "problem"), BAD.values(), ids=BAD)
def test_says_in_one_line_what_is_wrong(tmp_path, change, problem):
    a_history().save(tmp_path)
    change(tmp_path / FILE_NAME)
    with pytest.raises(BadFileError, match=problem) as caught:
        History.load(tmp_path)
    assert str(caught.value).startswith(str(tmp_path / FILE_NAME))
    assert "\n" not in str(caught.value)
