"""The compiled evaluation against NumPy in double precision, which is the reference."""

import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.directions import from_degrees
from gonio.errors import BadInputError
from nnbrdf import taught
from nnbrdf.activations import ACTIVATIONS
from nnbrdf.evaluate import evaluate
from nnbrdf.halfway import HALFWAY, HALFWAY_INPUTS
from nnbrdf.network import Networks, glorot_uniform
from nnbrdf.prior.log import OFFSET
from nnbrdf.taught import TaughtBRDF, TaughtCard

_evaluate = pytest.importorskip("nnbrdf._evaluate", reason="the kernel was not compiled")
HIDDEN = (15, 29, 20)
SHAPES = [(), (1,), (3, 6, 4), (64, 64), (7, 8, 9, 1, 13), (2,) * 12]
STATED = 2e-5
RECIPROCAL = [name for name in HALFWAY if not name.endswith("-exchange")]
each_encoding = pytest.mark.parametrize("encoding", HALFWAY)
each_isa = pytest.mark.parametrize("isa", _evaluate.isas())


def a_network(encoding, activation="gelu", hidden=HIDDEN, outputs=3):
    """Twice as steep as a network at its start, with biases: outputs span several units."""
    sizes = (HALFWAY_INPUTS[encoding], *hidden, outputs)
    network = glorot_uniform(sizes, [np.random.default_rng(1)], np.float32, activation)
    rng = np.random.default_rng(5)
    for layer in network.layers:
        layer[...] *= 2 if activation != "exponential" else 0.5
        layer[..., -1] = rng.normal(size=layer.shape[:2]) / 4
    return network


def some_pairs(count=1009):
    """Uniform in both angles, to 89.99 degrees."""
    rng = np.random.default_rng(7)
    theta, phi = rng.uniform(0, 89.99, (2, count)), rng.uniform(0, 360, (2, count))
    return from_degrees(theta, phi)


def logs_of(network, encoding, light, view, isa=""):
    """What the kernel's values are the exponentials of."""
    values = np.empty_like(light)
    numbers = list(ACTIVATIONS).index(network.activation), list(HALFWAY).index(encoding)
    layers = [layer[0] for layer in network.layers]
    # without the offset nothing is cut at zero
    kernel = _evaluate.evaluate64 if light.dtype == np.float64 else _evaluate.evaluate32
    kernel(layers, *numbers, 1.0, 0.0, (1.0, 1.0, 1.0), light, view, values, isa)
    return np.log(values)


def expected_values(network, encoding, light, view):
    logs = network.forward(HALFWAY[encoding](light, view))[0]
    return np.broadcast_to((np.exp(logs.clip(max=50)) - OFFSET).clip(0), light.shape)


def assert_close(logs, expected):
    assert np.ptp(expected) > 0.1
    assert abs(logs - expected).max() <= STATED * np.ptp(expected)


@pytest.mark.parametrize("activation", ACTIVATIONS)
@each_encoding
@each_isa
def test_every_activation_and_encoding_is_that_of_numpy(activation, encoding, isa):
    network, (light, view) = a_network(encoding, activation), some_pairs()
    expected = network.forward(HALFWAY[encoding](light, view))[0]
    assert_close(logs_of(network, encoding, light, view, isa), expected)


@each_encoding
@each_isa
def test_single_precision_directions_are_evaluated_as_they_are(encoding, isa):
    network = a_network(encoding)
    light, view = (each.astype(np.float32) for each in some_pairs())
    expected = network.forward(HALFWAY[encoding](light.astype(float), view.astype(float)))[0]
    assert_close(logs_of(network, encoding, light, view, isa), expected)


@pytest.mark.parametrize("hidden", SHAPES, ids=str)
@pytest.mark.parametrize("activation", ["gelu", "softmax"])
@each_isa
def test_networks_of_any_shape(hidden, activation, isa):
    encoding = "anisotropic"
    network, (light, view) = a_network(encoding, activation, hidden), some_pairs()
    expected = network.forward(HALFWAY[encoding](light, view))[0]
    logs = logs_of(network, encoding, light, view, isa)
    assert abs(logs - expected).max() <= STATED * max(np.ptp(expected), 1)


@each_isa
def test_gelu_is_within_a_millionth(isa):
    """One feature that is the sum of cosines times a slope: gelu by itself, at many totals."""
    x = np.linspace(0, 1, 20_001)
    light = np.stack([np.sqrt(1 - x**2), 0 * x, x], axis=1)
    for slope, bias in [(16, -8), (200, -100), (1e-3, 0)]:
        first = np.zeros((1, 1, 6), np.float32)
        first[..., 2], first[..., -1] = slope, bias
        network = Networks((first, np.array([[[-0.125, 0]]], np.float32)), "gelu")
        expected = network.forward(HALFWAY["isotropic"](light, light))[0]
        logs = logs_of(network, "isotropic", light, light, isa)
        # rounding of the total itself aside
        assert abs(logs - expected).max() < 0.125 * (1e-6 + 2e-7 * (slope + abs(bias)))


@each_isa
@pytest.mark.parametrize("count", [0, 1, 2, 11, 12, 13, 24, 47, 48, 49, 97])
def test_a_value_hangs_on_its_own_pair_only(count, isa):
    encoding = "anisotropic-exchange"
    network, (light, view) = a_network(encoding), some_pairs(200)
    whole = logs_of(network, encoding, light, view, isa)
    part = logs_of(network, encoding, light[5 : 5 + count], view[5 : 5 + count], isa)
    assert part.shape == (count, 3)
    assert np.array_equal(part, whole[5 : 5 + count])


@pytest.mark.parametrize("threads", [2, 3, 50])
def test_the_number_of_threads_does_not_matter(threads):
    network, (light, view) = a_network("anisotropic"), some_pairs()
    alone = evaluate(network, "anisotropic", light, view)
    assert np.array_equal(evaluate(network, "anisotropic", light, view, threads=threads), alone)
    few = evaluate(network, "anisotropic", light[:2], view[:2], threads=threads)
    assert np.array_equal(few, alone[:2])


def test_values_have_scale_offset_and_tint_and_are_not_negative():
    network, (light, view) = a_network("anisotropic", outputs=1), some_pairs()
    network.layers[-1][..., -1] -= 5.5
    expected = 3 * expected_values(network, "anisotropic", light, view) * [1, 0.5, 0.25]
    values = evaluate(network, "anisotropic", light, view, 3.0, (1.0, 0.5, 0.25))
    assert 0.2 < (expected == 0).mean() < 0.8
    assert values.min() == 0
    assert np.allclose(values, expected, rtol=1e-4, atol=1e-6)


def test_directions_are_broadcast():
    network, (light, view) = a_network("isotropic"), some_pairs(35)
    grid = evaluate(network, "isotropic", light[:5, None], view[None, :7])
    assert grid.shape == (5, 7, 3)
    assert grid.dtype == np.float64
    assert np.array_equal(grid[3, 4], evaluate(network, "isotropic", light[3], view[4]))
    strided = evaluate(network, "isotropic", light[::2], view[::2])
    assert np.array_equal(strided, evaluate(network, "isotropic", light, view)[::2])


def test_single_precision_directions_give_single_precision():
    network, (light, view) = a_network("isotropic"), some_pairs(35)
    single = evaluate(network, "isotropic", light.astype(np.float32), view.astype(np.float32))
    assert single.dtype == np.float32
    assert np.allclose(single, evaluate(network, "isotropic", light, view), rtol=1e-4)


POLE, GRAZING = from_degrees(0, 0), from_degrees(89.9, 30)
PLACES = {
    "both at the pole": (POLE, POLE),
    "pole and grazing": (POLE, GRAZING),
    "same and grazing": (GRAZING, GRAZING),
    "opposite and grazing": (GRAZING, from_degrees(89.9, 210)),
    "nearly opposite": (from_degrees(89.99999, 30), from_degrees(89.99999, 210.0001)),
    "opposite up to rounding": (from_degrees(90, 30), from_degrees(90, 210)),
    "taken as opposite": (np.array([0.6, 0.8, 0.0]), np.array([-0.6 + 5e-10, -0.8, 0.0])),
    "opposite and horizontal": (np.array([0.6, 0.8, 0.0]), np.array([-0.6, -0.8, 0.0])),
    "below": (np.array([0.6, 0.0, -0.8]), from_degrees(30, 0)),
    "neighbours": (GRAZING, from_degrees(89.9, 30 + 1e-6)),
}


@pytest.mark.parametrize("place", PLACES)
@each_encoding
@each_isa
def test_poles_and_grazing_directions(place, encoding, isa):
    network = a_network(encoding)
    light, view = (direction[None].copy() for direction in PLACES[place])
    expected = network.forward(HALFWAY[encoding](light, view))[0]
    logs = logs_of(network, encoding, light, view, isa)
    assert np.allclose(logs, expected, rtol=0, atol=2 * STATED)


@each_isa
def test_what_is_no_direction_has_no_value(isa):
    network, (light, view) = a_network("anisotropic"), some_pairs(30)
    light[7, 1] = np.nan
    logs = logs_of(network, "anisotropic", light, view, isa)
    assert np.array_equal(np.isnan(logs).all(axis=1), np.arange(30) == 7)


@given(
    st.sampled_from(RECIPROCAL),
    st.lists(st.floats(0, 89.999), min_size=2, max_size=2),
    st.lists(st.floats(0, 360), min_size=2, max_size=2),
)
def test_reciprocal_inputs_make_reciprocal_values(encoding, theta, phi):
    network = a_network(encoding)
    light, view = from_degrees(np.array(theta), np.array(phi))
    one, other = (evaluate(network, encoding, *pair) for pair in [(light, view), (view, light)])
    assert np.allclose(one, other, rtol=2e-5, atol=1e-6)


NETWORK = a_network("isotropic")
REFUSED = {
    "unknown encoding": ((NETWORK, "xyz"), "encoding 'xyz' is not known"),
    "inputs": ((NETWORK, "anisotropic"), "takes 5 inputs"),
    "outputs": ((a_network("isotropic", outputs=2), "isotropic"), "has 2 outputs"),
    "members": ((NETWORK.select([0, 0]), "isotropic"), "one network is evaluated"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_does_not_fit_is_refused(case):
    arguments, message = REFUSED[case]
    with pytest.raises(BadInputError, match=message):
        evaluate(*arguments, *some_pairs(3))


BROKEN = {
    "activation": ({"activation": 20}, "no activation"),
    "encoding": ({"encoding": -1}, "no encoding"),
    "layers": ({"layers": []}, "one output or three"),
    "layer": ({"layers": [np.ones((3, 7))]}, "do not fit together"),
    "rows": ({"light": np.ones((2, 3))}, "one shape"),
    "columns": ({"view": np.ones((4, 2))}, "one shape"),
    "isa": ({"isa": "mmx"}, "no vector width mmx"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_the_kernel_checks_what_it_is_given(case):
    given_, message = BROKEN[case]
    fine = {
        "layers": [np.ones((3, 6))], "activation": 0, "encoding": 0, "scale": 1.0, "offset": 0.0,
        "tint": (1.0, 1.0, 1.0), "light": np.ones((4, 3)), "view": np.ones((4, 3)),
        "values": np.empty((4, 3)),
    }  # fmt: skip
    _evaluate.evaluate64(**fine)
    with pytest.raises(ValueError, match=message):
        _evaluate.evaluate64(**fine | given_)


def test_values_go_where_they_are_wanted_or_nowhere():
    rows = np.ones((4, 3))
    with pytest.raises(TypeError):
        _evaluate.evaluate64([np.ones((3, 6))], 0, 0, 1.0, 0.0, (1, 1, 1), rows, rows, rows.T)
    rows.flags.writeable = False
    with pytest.raises(ValueError, match="writeable"):
        _evaluate.evaluate64([np.ones((3, 6))], 0, 0, 1.0, 0.0, (1, 1, 1), rows, rows, rows)


def test_a_taught_model_says_the_same_without_the_kernel(monkeypatch):
    light, view = some_pairs(300)
    network = a_network("anisotropic", outputs=1)
    card = TaughtCard.model_construct(encoding="anisotropic", scale=3.0, tint=(1.0, 0.5, 0.25))
    model = TaughtBRDF(card, network, network)
    quick = model.evaluate(light[:20, None], view[None, :15])
    monkeypatch.setattr(taught, "is_available", lambda: False)
    slow = model.evaluate(light[:20, None], view[None, :15])
    assert quick.shape == slow.shape == (20, 15, 3)
    assert not np.array_equal(quick, slow)
    assert np.allclose(quick, slow, rtol=1e-3, atol=1e-5)


def test_without_the_kernel_numpy_evaluates():
    script = (
        "import sys; sys.modules['nnbrdf._evaluate'] = None\n"
        "from nnbrdf import evaluate, taught\n"
        "assert not evaluate.is_available() and not taught.is_available()\n"
        "evaluate.evaluate(None, 'isotropic', None, None)\n"
    )
    ran = subprocess.run(
        [sys.executable, "-c", script], check=False, env=os.environ, capture_output=True, text=True
    )
    assert ran.stderr.strip().splitlines()[-1].endswith("or evaluate with Networks.forward")
