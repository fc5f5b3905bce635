"""The hand-written gradient and optimizer against torch's own, and the ensemble against members."""

import numpy as np
import pytest
import torch

from nnbrdf.adamax import RATE, Adamax
from nnbrdf.gradient import Gradient, Parameters
from nnbrdf.network import Networks, glorot_uniform
from nnbrdf.training import checkpoint_steps, epoch_steps, train

SIZES = (6, 15, 30, 20, 3)


def generators(count, seed=0):
    return [np.random.default_rng(each) for each in np.random.SeedSequence(seed).spawn(count)]


def a_start(members=3, dtype=np.float64, sizes=SIZES):
    networks = glorot_uniform(sizes, generators(members), dtype)
    for layer in networks.layers:
        layer[..., -1] = np.random.default_rng(5).normal(size=layer.shape[:2]) / 10
    return networks


def some_samples(count, outputs=3):
    rng = np.random.default_rng(7)
    return rng.normal(size=(count, 6)), rng.random((count, outputs))


def torch_forward(layers, inputs):
    signal = inputs
    for index, layer in enumerate(layers):
        signal = torch.nn.functional.linear(signal, layer[:, :-1], layer[:, -1])
        if index < len(layers) - 1:
            signal = torch.nn.functional.softsign(signal)
    return signal


@pytest.mark.parametrize("batch", [32, 4, 1])
@pytest.mark.parametrize("sizes", [SIZES, (6, 3, 6, 4, 1), (6, 3)], ids=str)
def test_the_gradient_is_the_one_of_autograd(batch, sizes):
    networks = a_start(3, sizes=sizes)
    rng = np.random.default_rng(3)
    inputs = torch.from_numpy(rng.normal(size=(3, batch, 6)))
    targets = torch.from_numpy(rng.random((3, batch, sizes[-1])))
    parameters = Parameters(networks)
    columns = torch.cat([inputs, torch.ones(3, batch, 1, dtype=torch.float64)], dim=2)
    gradient = Gradient(parameters, batch)
    for _ in range(2):  # the buffers of a pass must not leak into the next
        gradient.compute(columns.transpose(1, 2).contiguous(), targets.transpose(1, 2).contiguous())
    for member in range(3):
        leaves = [torch.tensor(layer[member], requires_grad=True) for layer in networks.layers]
        outputs = torch_forward(leaves, inputs[member])
        torch.nn.functional.l1_loss(outputs, targets[member]).backward()
        for leaf, own in zip(leaves, parameters.layer_gradients, strict=True):
            assert torch.allclose(own[member], leaf.grad, rtol=1e-12, atol=1e-12)


def test_adamax_is_the_published_algorithm():
    rng = np.random.default_rng(2)
    value, gradient = torch.from_numpy(rng.normal(size=50)), torch.zeros(50, dtype=torch.float64)
    expected, mean, norm = value.numpy().copy(), np.zeros(50), np.zeros(50)
    adamax = Adamax(value, gradient)
    for step in range(1, 30):
        slope = rng.normal(size=50)
        gradient.copy_(torch.from_numpy(slope))
        adamax.step()
        mean = 0.9 * mean + 0.1 * slope
        norm = np.maximum(0.999 * norm, abs(slope))
        expected -= 0.0025 / (1 - 0.9**step) * mean / (norm + 1e-7)
    assert np.allclose(value.numpy(), expected, rtol=1e-13, atol=1e-13)


def reference_training(layers, inputs, targets, steps, generator):
    """One network as anybody would train it with torch, on the same order of samples."""
    leaves = [torch.tensor(layer, requires_grad=True) for layer in layers]
    # torch adds the epsilon inside the maximum: next to nothing unless gradients vanish
    optimizer = torch.optim.Adamax(leaves, lr=RATE, eps=1e-7)
    inputs, targets = torch.from_numpy(inputs), torch.from_numpy(targets)
    taken = 0
    while taken < steps:
        order = torch.from_numpy(generator.permutation(len(inputs)))
        for part in order.split(32):
            if taken == steps:
                break
            optimizer.zero_grad()
            outputs = torch_forward(leaves, inputs[part])
            torch.nn.functional.l1_loss(outputs, targets[part]).backward()
            optimizer.step()
            taken += 1
    return [leaf.detach().numpy() for leaf in leaves]


def test_members_end_where_a_plain_torch_training_ends():
    networks = a_start(3)
    inputs, targets = some_samples(70)  # batches of 32, 32 and 6
    trained = train(networks, inputs, targets, 20, generators(3))[-1].networks
    for member, generator in enumerate(generators(3)):
        layers = [layer[member] for layer in networks.layers]
        expected = reference_training(layers, inputs, targets, 20, generator)
        for own, other, start in zip(trained.layers, expected, layers, strict=True):
            assert np.allclose(own[member], other, rtol=0, atol=1e-6)
            assert not np.allclose(own[member], start, rtol=0, atol=1e-3)


def test_together_is_as_each_alone():
    networks = a_start(5)
    inputs, targets = some_samples(70)
    together = train(networks, inputs, targets, 30, generators(5))[-1].networks
    for member in range(5):
        alone = train(
            networks.member(member), inputs, targets, 30, generators(5)[member : member + 1]
        )[-1].networks
        for a, b in zip(together.member(member).layers, alone.layers, strict=True):
            assert np.allclose(a, b, rtol=0, atol=1e-12)


def test_the_same_seed_gives_the_same_bits():
    inputs, targets = some_samples(50)
    runs = [
        train(a_start(2, np.float32), inputs, targets, 40, generators(2))[-1].networks
        for _ in range(2)
    ]
    for a, b in zip(runs[0].layers, runs[1].layers, strict=True):
        assert a.dtype == np.float32
        assert np.array_equal(a, b)


def test_members_see_the_samples_in_orders_of_their_own():
    start = a_start(1).layers
    twice = Networks(tuple(np.concatenate([layer, layer]) for layer in start))
    inputs, targets = some_samples(50)
    first, second = (
        train(twice, inputs, targets, 5, generators(2))[-1].networks.layers[0][index]
        for index in range(2)
    )
    assert not np.allclose(first, second)


def test_training_learns():
    inputs, _ = some_samples(200)
    targets = 0.5 + 0.3 * np.tanh(inputs[:, :3])
    checkpoints = train(a_start(2, np.float32), inputs, targets, 1500, generators(2))
    assert (checkpoints[-1].loss < 0.1 * checkpoints[0].loss).all()


def test_checkpoints_tell_step_seconds_loss_and_weights():
    inputs, targets = some_samples(40)
    networks = a_start(2)
    checkpoints = train(networks, inputs, targets, 100, generators(2))
    assert [point.step for point in checkpoints] == checkpoint_steps(100)
    seconds = [point.seconds for point in checkpoints]
    assert seconds == sorted(seconds)
    assert seconds[0] >= 0
    for point in checkpoints:
        residual = point.networks.forward(inputs) - targets
        assert np.allclose(point.loss, abs(residual).mean(axis=(1, 2)))
    assert not np.array_equal(checkpoints[0].networks.layers[0], checkpoints[1].networks.layers[0])


@pytest.mark.parametrize("steps", [1, 2, 30, 3500, 103_000])
def test_checkpoints_rise_to_the_last_step(steps):
    chosen = checkpoint_steps(steps)
    assert chosen == sorted(set(chosen))
    assert chosen[-1] == steps
    assert min(steps, 15) <= len(chosen) <= 25


@pytest.mark.parametrize(("samples", "steps"), [(196, 7), (6561, 206), (32, 1), (33, 2), (8, 1)])
def test_the_last_partial_batch_is_a_step(samples, steps):
    assert epoch_steps(samples) == steps


def test_progress_ends_with_everything():
    inputs, targets = some_samples(40)
    calls = []
    train(
        a_start(2),
        inputs,
        targets,
        250,
        generators(2),
        lambda done, total: calls.append((done, total)),
    )
    assert calls[-1] == (250, 250)
    assert calls == sorted(calls)
    assert 50 < len(calls) <= 130


def test_the_number_of_threads_is_as_before_even_after_a_failure():
    before = torch.get_num_threads()
    torch.set_num_threads(2)
    inputs, targets = some_samples(40)
    seen = []

    def stop(done, total):
        seen.append(torch.get_num_threads())
        raise KeyboardInterrupt

    try:
        with pytest.raises(KeyboardInterrupt):
            train(a_start(2), inputs, targets, 10, generators(2), stop)
        assert (seen, torch.get_num_threads()) == ([1], 2)
    finally:
        torch.set_num_threads(before)
