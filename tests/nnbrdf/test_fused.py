"""The compiled kernel against torch in double precision, which is the reference."""

import os
import subprocess
import sys
from threading import Barrier, Thread

import numpy as np
import pytest
import torch

from gonio.errors import BadInputError
from nnbrdf import fused
from nnbrdf.activations import ACTIVATIONS, RRELU_LOWER, RRELU_UPPER
from nnbrdf.batched import TORCH_ACTIVATIONS, forward
from nnbrdf.network import glorot_uniform
from nnbrdf.training import RATE, make_trainer

_fused = pytest.importorskip("nnbrdf._fused", reason="the kernel was not compiled")
SIZES = (6, 15, 30, 20, 3)
SHAPES = [SIZES, (6, 3, 6, 4, 1), (6, 3), (8, 16, 32, 3), (2, 1, 1, 1, 1, 1, 1, 1, 5)]
each = pytest.mark.parametrize("name", ACTIVATIONS)
each_isa = pytest.mark.parametrize("isa", _fused.isas())


def a_start(sizes=SIZES, activation="softsign", dtype=np.float64, seed=0):
    networks = glorot_uniform(sizes, [np.random.default_rng(seed)], dtype, activation)
    for layer in networks.layers:
        layer[..., -1] = np.random.default_rng(5).normal(size=layer.shape[:2]) / 10
    return networks


def some_samples(count, sizes=SIZES):
    rng = np.random.default_rng(7)
    # as small as directions are: exponentials of exponentials of more lose all digits
    return rng.uniform(-1, 1, (count, sizes[0])) / 2, rng.random((count, sizes[-1]))


def a_trainer(networks, samples, seed=3, isa=""):
    kind = _fused.Trainer32 if networks.layers[0].dtype == np.float32 else _fused.Trainer64
    number = list(ACTIVATIONS).index(networks.activation)
    return kind([layer[0] for layer in networks.layers], number, *samples, seed, RATE, isa)


def scramble(x):
    """The kernel's hash, in Python's whole numbers."""
    x ^= x >> 16
    x = x * 0x7FEB352D & 0xFFFFFFFF
    x ^= x >> 15
    x = x * 0x846CA68B & 0xFFFFFFFF
    return x ^ (x >> 16)


def rrelu_slopes(seed, step, layer, shape):
    key = scramble((seed + scramble((step * 16 + layer) & 0xFFFFFFFF)) & 0xFFFFFFFF)
    count = int(np.prod(shape))
    bits = [scramble((key + index) & 0xFFFFFFFF) >> 8 for index in range(count)]
    drawn = RRELU_LOWER + (RRELU_UPPER - RRELU_LOWER) * np.array(bits) * 2.0**-24
    return torch.from_numpy(drawn.reshape(shape))


def activation_at(name, seed, step):
    """What a training applies at one step; it counts the layers that it is called for."""
    if name != "rrelu":
        return TORCH_ACTIVATIONS[name]
    layers = iter(range(1, 9))

    def activate(x):
        return torch.where(x < 0, rrelu_slopes(seed, step, next(layers), x.shape[1:]) * x, x)

    return activate


def torch_gradient(layers, batch, activate):
    leaves = [torch.tensor(layer[None], requires_grad=True) for layer in layers]
    inputs, targets = (torch.from_numpy(rows)[None] for rows in batch)
    (forward(leaves, inputs, activate) - targets).abs().mean().backward()
    return [leaf.grad[0].numpy() for leaf in leaves]


@each
@each_isa
@pytest.mark.parametrize("batch", [32, 5, 1])
def test_every_gradient_is_that_of_torch(name, isa, batch):
    networks, samples = a_start(activation=name), some_samples(40)
    trainer = a_trainer(networks, samples, isa=isa)
    chosen = np.random.default_rng(1).permutation(40)[:batch]
    expected = torch_gradient(
        [layer[0] for layer in networks.layers],
        [rows[chosen] for rows in samples],
        activation_at(name, 3, 0),
    )
    for _ in range(2):  # nothing of a pass may leak into the next
        for own, other in zip(trainer.gradient(chosen), expected, strict=True):
            assert np.allclose(own, other, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("sizes", SHAPES, ids=str)
@each_isa
def test_networks_of_any_shape(sizes, isa):
    networks, samples = a_start(sizes, "tanh"), some_samples(9, sizes)
    trainer = a_trainer(networks, samples, isa=isa)
    assert np.allclose(trainer.predict(samples[0]), networks.forward(samples[0])[0], rtol=1e-12)
    layers = [layer[0] for layer in networks.layers]
    expected = torch_gradient(layers, samples, torch.tanh)
    for own, other in zip(trainer.gradient(np.arange(9)), expected, strict=True):
        assert np.allclose(own, other, rtol=1e-12, atol=1e-12)


def test_samples_and_inputs_that_are_not_there_are_refused():
    trainer = a_trainer(a_start(), some_samples(9))
    with pytest.raises(ValueError, match="no such sample"):
        trainer.gradient(np.array([9]))
    with pytest.raises(ValueError, match="inputs must have shape"):
        trainer.predict(np.zeros((4, 5)))


@each
@pytest.mark.parametrize("count", [70, 64])
def test_a_hundred_steps_are_those_of_torch(name, count):
    # batches of 32, 32 and 6, or none of these
    networks, samples = a_start(activation=name), some_samples(count)
    trainer = a_trainer(networks, samples)
    layers = [layer[0].copy() for layer in networks.layers]
    mean, norm = ([np.zeros_like(layer) for layer in layers] for _ in range(2))
    for step in range(100):
        trainer.run(1)
        part = trainer.order[step % -(-count // 32) * 32 :][:32]
        slopes = torch_gradient(
            layers, [rows[part] for rows in samples], activation_at(name, 3, step)
        )
        for index, slope in enumerate(slopes):
            mean[index] = 0.9 * mean[index] + 0.1 * slope
            norm[index] = np.maximum(0.999 * norm[index], abs(slope))
            layers[index] -= RATE / (1 - 0.9 ** (step + 1)) * mean[index] / (norm[index] + 1e-7)
    assert trainer.step == 100
    for own, other in zip(trainer.layers, layers, strict=True):
        assert np.allclose(own, other, rtol=0, atol=1e-10)
    # only there: shrinking activations pass nothing back at first
    assert not np.allclose(trainer.layers[-1], networks.layers[-1][0], atol=1e-3)


def test_an_epoch_sees_every_sample_once_in_a_new_order():
    trainer = a_trainer(a_start(), some_samples(70))
    orders = []
    for _ in range(3):
        trainer.run(3)
        orders.append(trainer.order)
    assert all(sorted(order) == list(range(70)) for order in orders)
    assert len({tuple(order) for order in orders}) == 3


def test_every_place_in_the_order_is_as_likely():
    counts = np.zeros((5, 5))
    for seed in range(2000):
        trainer = a_trainer(a_start((6, 1)), some_samples(5, (6, 1)), seed * 7919)
        trainer.run(1)
        counts[np.arange(5), trainer.order] += 1
    assert np.sum((counts - 400) ** 2 / 400) < 45  # chi-square, 16 degrees of freedom: 1e-4


@pytest.mark.parametrize("name", ["softsign", "gelu", "rrelu", "softmax"])
def test_single_precision_follows_double_for_a_while(name):
    single, double = (a_start(activation=name, dtype=dtype) for dtype in (np.float32, np.float64))
    samples = some_samples(70)
    trainers = [a_trainer(networks, samples) for networks in (single, double)]
    for trainer in trainers:
        trainer.run(20)
    for a, b in zip(*(trainer.layers for trainer in trainers), strict=True):
        assert np.allclose(a, b, rtol=0, atol=1e-4)


@pytest.mark.parametrize("name", ["softsign", "relu"])
def test_whole_trainings_agree_in_distribution(name):
    """Twenty seeds each; trajectories are chaotic, their ends are not."""
    directions = np.random.default_rng(0).normal(size=(196, 6))
    targets = 0.5 + 0.4 * np.sin(3 * directions[:, :3]) * np.exp(-(directions[:, 3:] ** 2))
    ends = []
    for trainer in ("fused", "torch"):
        generators = [np.random.default_rng(seed) for seed in range(20)]
        networks = glorot_uniform(SIZES, generators, np.float32, name)
        seeds = [int(each.integers(2**63)) for each in generators]
        running = make_trainer(networks, directions, targets, seeds, trainer)
        running.run(400)
        ends.append(abs(running.predict(directions) - targets).mean(axis=(1, 2)))
    means = [loss.mean() for loss in ends]
    error = np.hypot(*(loss.std(ddof=1) / np.sqrt(20) for loss in ends))
    assert abs(means[0] - means[1]) < 2 * error
    assert error < 0.05 * means[0]


def test_the_number_of_threads_does_not_matter(monkeypatch):
    ends = []
    for count in (1, 3):
        monkeypatch.setattr(fused, "cores", lambda count=count: count)
        generators = [np.random.default_rng(seed) for seed in range(4)]
        networks = glorot_uniform(SIZES, generators)
        trainer = fused.FusedTrainer(networks, *some_samples(70), range(4), RATE)
        trainer.run(200)
        ends.append(trainer.networks())
    for a, b in zip(*(networks.layers for networks in ends), strict=True):
        assert np.array_equal(a, b)


@pytest.mark.parametrize("name", ["softsign", "rrelu"])
def test_a_training_in_parts_is_the_training_in_one_go(name):
    whole, parts = (a_trainer(a_start(activation=name), some_samples(70)) for _ in range(2))
    whole.run(100)
    for steps in (1, 0, 30, 69):
        parts.run(steps)
        parts.predict(some_samples(50)[0])
    for a, b in zip(whole.layers, parts.layers, strict=True):
        assert np.array_equal(a, b)


def test_two_threads_with_one_trainer_take_turns():
    whole, shared = (a_trainer(a_start(), some_samples(70)) for _ in range(2))
    whole.run(10_000)
    together = Barrier(2)

    def run():
        together.wait()
        shared.run(5000)

    threads = [Thread(target=run) for _ in range(2)]
    for thread in threads:
        thread.start()
    # who only looks waits for its turn as well
    shared.predict(some_samples(50)[0])
    shared.gradient(np.arange(32, dtype=np.uint32))
    assert shared.step in (0, 5000, 10_000)
    for thread in threads:
        thread.join()
    assert shared.step == 10_000
    for a, b in zip(whole.layers, shared.layers, strict=True):
        assert np.array_equal(a, b)


@pytest.mark.parametrize(
    "broken", [(np.zeros((3, 5)), np.zeros((3, 3))), (np.zeros((3, 6)), np.zeros((4, 3)))]
)
def test_samples_that_do_not_fit_are_refused(broken):
    with pytest.raises(ValueError, match="inputs and targets do not fit the layers"):
        a_trainer(a_start(), broken)


@pytest.mark.parametrize("number", [-1, 20])
def test_an_activation_that_is_none_is_refused(number):
    layers = [layer[0] for layer in a_start().layers]
    with pytest.raises(ValueError, match="there is no activation"):
        _fused.Trainer64(layers, number, *some_samples(9), 0, RATE)
    with pytest.raises(ValueError, match="there is no activation"):
        _fused.activate64(number, np.zeros((1, 3)))


def test_no_rows_predict_nothing():
    trainer = a_trainer(a_start(), some_samples(9))
    assert trainer.predict(np.empty((0, 6))).shape == (0, 3)


def test_too_many_layers_for_the_kernel():
    networks = a_start((6,) + (2,) * 9)
    with pytest.raises(BadInputError, match="takes 8, the trainer torch takes more"):
        make_trainer(networks, *some_samples(9, (6, 2)), [0], "fused")
    make_trainer(networks, *some_samples(9, (6, 2)), [0], "torch").run(2)


def test_without_the_kernel_torch_trains():
    script = (
        "import sys; sys.modules['nnbrdf._fused'] = None\n"
        "from nnbrdf import fused, training\n"
        "assert not fused.is_available()\n"
        "from nnbrdf.network import glorot_uniform\n"
        "import numpy as np\n"
        "start = glorot_uniform((2, 3, 1), [np.random.default_rng(0)])\n"
        "training.make_trainer(start, np.ones((4, 2)), np.ones((4, 1)), [0]).run(2)\n"
        "assert training.default_trainer() == 'torch'\n"
    )
    ran = subprocess.run(
        [sys.executable, "-c", script], check=True, env=os.environ, capture_output=True, text=True
    )
    assert "install a C++ compiler" in ran.stderr
