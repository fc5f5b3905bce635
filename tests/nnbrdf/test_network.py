import numpy as np
import pytest

from nnbrdf.encoding import ENCODINGS, INPUTS, encode_xyz
from nnbrdf.network import Networks, glorot_uniform, weight_count

PAPER = (6, 15, 30, 20, 3)


def generators(count, seed=0):
    return [np.random.default_rng(each) for each in np.random.SeedSequence(seed).spawn(count)]


@pytest.mark.parametrize(
    ("sizes", "count"), [(PAPER, 1268), ((6, 3, 6, 4, 3), 88), ((6, 1), 7)], ids=str
)
def test_weights_are_counted_as_they_are_stored(sizes, count):
    assert weight_count(sizes) == count
    assert sum(layer.size for layer in glorot_uniform(sizes, generators(1)).layers) == count


def test_forward_is_the_network_written_out():
    networks = glorot_uniform((2, 3, 2), generators(4))
    networks.layers[0][..., -1] = 0.3
    networks.layers[1][..., -1] = -0.2
    inputs = np.random.default_rng(1).normal(size=(5, 2))
    outputs = networks.forward(inputs)
    assert outputs.shape == (4, 5, 2)
    for member in range(4):
        first, second = (layer[member].astype(float) for layer in networks.layers)
        for sample in range(5):
            total = first[:, :2] @ inputs[sample] + first[:, 2]
            hidden = total / (1 + abs(total))
            expected = second[:, :3] @ hidden + second[:, 3]
            assert np.allclose(outputs[member, sample], expected, rtol=1e-14, atol=1e-14)


def test_a_member_alone_says_what_it_says_among_others():
    networks = glorot_uniform(PAPER, generators(3))
    inputs = np.random.default_rng(1).normal(size=(7, 6))
    alone = networks.member(1)
    assert alone.sizes == networks.sizes == PAPER
    assert (alone.members, networks.members) == (1, 3)
    assert np.allclose(alone.forward(inputs)[0], networks.forward(inputs)[1], rtol=1e-13)


def test_glorot_uniform_fills_its_range_and_leaves_biases_at_zero():
    networks = glorot_uniform(PAPER, generators(200))
    for layer in networks.layers:
        outputs, inputs = layer.shape[1], layer.shape[2] - 1
        limit = np.sqrt(6 / (inputs + outputs))
        weights = layer[..., :-1]
        assert not layer[..., -1].any()
        assert 0.99 * limit < abs(weights).max() <= limit * (1 + 1e-6)
        assert weights.std() == pytest.approx(limit / np.sqrt(3), rel=0.02)
        assert layer.dtype == np.float32


def test_members_start_differently_and_a_seed_repeats():
    first, second = glorot_uniform(PAPER, generators(2)), glorot_uniform(PAPER, generators(2))
    other = glorot_uniform(PAPER, generators(2, seed=1))
    for a, b, c in zip(first.layers, second.layers, other.layers, strict=True):
        assert np.array_equal(a, b)
        assert not np.array_equal(a[0], a[1])
        assert not np.array_equal(a, c)


def test_the_inputs_are_the_view_then_the_light():
    light, view = np.array([[1.0, 2.0, 3.0]]), np.array([[4.0, 5.0, 6.0]])
    assert encode_xyz(light, view).tolist() == [[4, 5, 6, 1, 2, 3]]


@pytest.mark.parametrize("name", ENCODINGS)
def test_every_encoding_has_as_many_inputs_as_it_says(name):
    assert ENCODINGS[name](np.eye(3), np.eye(3)).shape == (3, INPUTS[name])


def test_layers_must_follow_each_other():
    with pytest.raises(ValueError, match="do not fit together"):
        Networks((np.zeros((5, 4, 7)), np.zeros((5, 3, 4))))


def test_the_output_is_linear():
    networks = Networks((np.array([[[2.0, 1.0]]]),))
    assert networks.forward(np.array([[10.0]])).tolist() == [[[21.0]]]
