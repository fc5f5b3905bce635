"""Both trainers through one door: what a training does, whoever does it."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import torch

from gonio.errors import BadInputError
from nnbrdf import fused
from nnbrdf.network import Networks, glorot_uniform
from nnbrdf.training import RATE, checkpoint_steps, epoch_steps, losses, make_trainer, train

SIZES = (6, 15, 30, 20, 3)
TRAINERS = ["fused", "torch"] if fused.is_available() else ["torch"]
each_trainer = pytest.mark.parametrize("trainer", TRAINERS)


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


def seeds(count, seed=0):
    return [int(each.integers(2**63)) for each in generators(count, seed)]


def torch_forward(layers, inputs):
    signal = inputs
    for index, layer in enumerate(layers):
        signal = torch.nn.functional.linear(signal, layer[:, :-1], layer[:, -1])
        if index < len(layers) - 1:
            signal = torch.nn.functional.softsign(signal)
    return signal


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


def test_members_of_torch_end_where_a_plain_torch_training_ends():
    networks = a_start(3)
    inputs, targets = some_samples(70)  # batches of 32, 32 and 6
    trained = train(networks, inputs, targets, 20, seeds(3), trainer="torch")[-1].networks
    for member, seed in enumerate(seeds(3)):
        layers = [layer[member] for layer in networks.layers]
        generator = np.random.default_rng(seed)
        expected = reference_training(layers, inputs, targets, 20, generator)
        for own, other, start in zip(trained.layers, expected, layers, strict=True):
            assert np.allclose(own[member], other, rtol=0, atol=1e-6)
            assert not np.allclose(own[member], start, rtol=0, atol=1e-3)


@each_trainer
@pytest.mark.parametrize("activation", ["softsign", "rrelu"])
def test_together_is_as_each_alone(trainer, activation):
    networks = replace(a_start(5), activation=activation)
    inputs, targets = some_samples(70)
    together = train(networks, inputs, targets, 30, seeds(5), trainer=trainer)[-1].networks
    for member in range(5):
        alone = train(
            networks.member(member),
            inputs,
            targets,
            30,
            seeds(5)[member : member + 1],
            trainer=trainer,
        )[-1].networks
        for a, b in zip(together.member(member).layers, alone.layers, strict=True):
            assert np.allclose(a, b, rtol=0, atol=1e-12)


@each_trainer
def test_slopes_of_rrelu_are_random_in_training_and_each_member_has_its_own(trainer):
    # of a single batch the order is all the same
    start = a_start(1)
    inputs, targets = some_samples(20)

    def trained(activation, seed):
        networks = replace(start, activation=activation)
        return train(networks, inputs, targets, 10, [seed], trainer=trainer)[-1].networks.layers[0]

    assert np.allclose(trained("elu", 1), trained("elu", 2), rtol=0, atol=1e-9)
    assert not np.allclose(trained("rrelu", 1), trained("rrelu", 2), rtol=0, atol=1e-6)


@each_trainer
def test_the_same_seed_gives_the_same_bits(trainer):
    inputs, targets = some_samples(50)
    runs = [
        train(a_start(2, np.float32), inputs, targets, 40, seeds(2), trainer=trainer)[-1].networks
        for _ in range(2)
    ]
    for a, b in zip(runs[0].layers, runs[1].layers, strict=True):
        assert a.dtype == np.float32
        assert np.array_equal(a, b)


@each_trainer
def test_members_see_the_samples_in_orders_of_their_own(trainer):
    start = a_start(1).layers
    twice = Networks(tuple(np.concatenate([layer, layer]) for layer in start))
    inputs, targets = some_samples(50)
    trained = train(twice, inputs, targets, 5, seeds(2), trainer=trainer)[-1].networks
    assert not np.allclose(trained.layers[0][0], trained.layers[0][1])


@each_trainer
def test_training_learns(trainer):
    inputs, _ = some_samples(200)
    targets = 0.5 + 0.3 * np.tanh(inputs[:, :3])
    checkpoints = train(a_start(2, np.float32), inputs, targets, 1500, seeds(2), trainer=trainer)
    assert (checkpoints[-1].loss < 0.1 * checkpoints[0].loss).all()
    assert not checkpoints[-1].diverged.any()


@each_trainer
def test_a_member_whose_gradient_overflows_stops_and_the_others_go_on(trainer):
    networks = glorot_uniform((6, 4, 3), generators(2), np.float32, "exponential")
    networks.layers[0][1] = 1e4
    inputs, targets = some_samples(50)
    end = train(networks, abs(inputs), targets, 20, seeds(2), trainer=trainer)[-1]
    assert end.diverged.tolist() == [False, True]
    assert np.array_equal(end.networks.layers[0][1], networks.layers[0][1])
    assert not np.array_equal(end.networks.layers[0][0], networks.layers[0][0])
    assert all(np.isfinite(layer).all() for layer in end.networks.layers)


@each_trainer
def test_checkpoints_tell_step_seconds_loss_and_weights(trainer):
    inputs, targets = some_samples(40)
    networks = a_start(2)
    checkpoints = train(networks, inputs, targets, 100, seeds(2), trainer=trainer)
    assert [point.step for point in checkpoints] == checkpoint_steps(100)
    seconds = [point.seconds for point in checkpoints]
    assert seconds == sorted(seconds)
    assert seconds[0] >= 0
    for point in checkpoints:
        residual = point.networks.forward(inputs) - targets
        assert np.allclose(point.loss, abs(residual).mean(axis=(1, 2)))
    assert not np.array_equal(checkpoints[0].networks.layers[0], checkpoints[1].networks.layers[0])


@pytest.mark.parametrize(
    ("trainer", "message"),
    [("keras", "use fused, torch, cuda"), ("cuda", "finds no GPU here")],
)
def test_a_trainer_that_is_not_there(trainer, message):
    if trainer == "cuda" and torch.cuda.is_available():
        pytest.skip("there is a GPU")
    with pytest.raises(BadInputError, match=message):
        make_trainer(a_start(1), *some_samples(8), seeds(1), trainer)


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
        a_start(2), inputs, targets, 250, seeds(2), lambda done, total: calls.append((done, total))
    )
    assert calls[-1] == (250, 250)
    assert calls == sorted(calls)
    assert 50 < len(calls) <= 150


def test_the_number_of_torch_threads_is_as_before():
    before = torch.get_num_threads()
    torch.set_num_threads(2)
    try:
        train(a_start(2), *some_samples(40), 10, seeds(2), trainer="torch")
        assert torch.get_num_threads() == 2
    finally:
        torch.set_num_threads(before)


def test_losses_are_each_members_own_and_what_diverged_has_none():
    outputs = np.array([[[1, 2], [3, 4]], [[1, 1], [1, 1]], [[np.inf, -np.inf], [0, 0]]])
    ends = losses(outputs.astype(np.float32), np.ones((2, 2)))
    assert ends[:2].tolist() == [1.5, 0.0]
    assert not np.isfinite(ends[2])


def test_without_the_kernel_it_says_so_once_however_many_are_trained():
    program = (
        "import sys; sys.modules['nnbrdf._fused'] = None\n"
        "import numpy as np\n"
        "from nnbrdf.network import glorot_uniform\n"
        "from nnbrdf.training import train\n"
        "start = glorot_uniform((2, 3, 1), [np.random.default_rng(0)])\n"
        "for _ in range(3):\n"
        "    train(start, np.ones((9, 2)), np.ones((9, 1)), 2, [0])\n"
    )
    command = [sys.executable, "-c", program]
    ran = subprocess.run(command, check=True, capture_output=True, text=True)
    assert ran.stderr.count("no compiled trainer here, so torch trains, some 40 times slower") == 1
