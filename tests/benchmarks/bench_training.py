"""How long one network of the paper takes to train: the kernel, torch, Keras; in one run."""

from itertools import pairwise
from time import perf_counter

import numpy as np
import pytest
import torch

from nnbrdf.network import glorot_uniform
from nnbrdf.training import BATCH, RATE, make_trainer

SIZES, SAMPLES, FULL = (6, 15, 30, 20, 3), 6561, 103_000
MEMBERS = 40


def some_samples():
    rng = np.random.default_rng(0)
    return rng.normal(size=(SAMPLES, 6)), rng.random((SAMPLES, 3))


def seconds_per_step(trainer, steps):
    """Of one network among forty that train together; the best of three."""
    generators = [np.random.default_rng(seed) for seed in range(MEMBERS)]
    running = make_trainer(
        glorot_uniform(SIZES, generators), *some_samples(), range(MEMBERS), trainer
    )
    running.run(10)
    return best(lambda: running.run(steps)) / (steps * MEMBERS)


def torch_one_by_one(steps):
    layers = []
    for inputs, outputs in pairwise(SIZES):
        layers += [torch.nn.Linear(inputs, outputs), torch.nn.Softsign()]
    network = torch.nn.Sequential(*layers[:-1])
    optimizer = torch.optim.Adamax(network.parameters(), lr=RATE)
    inputs, targets = (torch.from_numpy(rows).float() for rows in some_samples())

    def train():
        order = torch.randperm(SAMPLES)
        for part in order[: steps * BATCH].split(BATCH):
            optimizer.zero_grad()
            torch.nn.functional.l1_loss(network(inputs[part]), targets[part]).backward()
            optimizer.step()

    return best(train) / steps


def keras_one_by_one():
    """One epoch with the framework and the settings of the paper, after one to warm up."""
    keras = pytest.importorskip("keras", reason="needs the extra bench")
    network = keras.Sequential(
        [keras.Input((6,))]
        + [keras.layers.Dense(size, activation="softsign") for size in SIZES[1:-1]]
        + [keras.layers.Dense(SIZES[-1])]
    )
    network.compile(optimizer=keras.optimizers.Adamax(RATE), loss="mean_absolute_error")
    inputs, targets = some_samples()
    network.fit(inputs, targets, batch_size=BATCH, epochs=1, verbose=0)

    def train():
        network.fit(inputs, targets, batch_size=BATCH, epochs=1, verbose=0)

    return best(train) / -(-SAMPLES // BATCH)


def best(function):
    """The best of three: what the machine can do when nobody else wants it."""
    seconds = []
    for _ in range(3):
        start = perf_counter()
        function()
        seconds.append(perf_counter() - start)
    return min(seconds)


def show(name, slow, quick):
    print(  # noqa: T201
        f"\n{name}: {1e6 * slow:.1f} us a step, {slow * FULL:.1f} s for 103,000 steps; "
        f"kernel: {1e6 * quick:.2f} us, {quick * FULL:.2f} s; ratio {slow / quick:.1f}"
    )


@pytest.fixture(scope="module")
def kernel():
    return seconds_per_step("fused", 5000)


def test_kernel_and_torch_forty_networks_in_one_batch(kernel):
    slow = seconds_per_step("torch", 100)
    show("torch, forty networks in one batch", slow, kernel)
    assert slow > 5 * kernel


def test_kernel_and_torch_one_network(kernel):
    slow = torch_one_by_one(200)
    show("torch, one network", slow, kernel)
    assert slow > 20 * kernel


def test_kernel_and_keras(kernel):
    slow = keras_one_by_one()
    show("Keras, one network", slow, kernel)
    assert slow > 50 * kernel
