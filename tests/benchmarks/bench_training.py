"""How much quicker five networks train together than one after the other with torch's own parts."""

from time import perf_counter

import numpy as np
import torch

from nnbrdf.adamax import RATE
from nnbrdf.network import glorot_uniform
from nnbrdf.training import BATCH, train

SIZES, MEMBERS, SAMPLES, STEPS = (6, 15, 30, 20, 3), 5, 196, 350
AT_LEAST = 4.0


def generators():
    return [np.random.default_rng(each) for each in np.random.SeedSequence(0).spawn(MEMBERS)]


def together(inputs, targets):
    train(glorot_uniform(SIZES, generators()), inputs, targets, STEPS, generators())


def torch_network():
    layers = []
    for index in range(len(SIZES) - 1):
        layer = torch.nn.Linear(SIZES[index], SIZES[index + 1])
        torch.nn.init.xavier_uniform_(layer.weight)
        layers += [layer, torch.nn.Softsign()]
    return torch.nn.Sequential(*layers[:-1])


def one_by_one(inputs, targets):
    inputs, targets = torch.from_numpy(inputs).float(), torch.from_numpy(targets).float()
    for _ in range(MEMBERS):
        network = torch_network()
        optimizer = torch.optim.Adamax(network.parameters(), lr=RATE)
        taken = 0
        while taken < STEPS:
            for part in torch.randperm(SAMPLES).split(BATCH):
                optimizer.zero_grad()
                torch.nn.functional.l1_loss(network(inputs[part]), targets[part]).backward()
                optimizer.step()
                taken += 1


def seconds(function, *arguments):
    """The best of three: what the machine can do when nobody else wants it."""
    best = float("inf")
    for _ in range(3):
        start = perf_counter()
        function(*arguments)
        best = min(best, perf_counter() - start)
    return best


def test_five_networks_together_and_one_by_one(record_property):
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        rng = np.random.default_rng(0)
        samples = rng.normal(size=(SAMPLES, 6)), rng.random((SAMPLES, 3))
        quick, slow = seconds(together, *samples), seconds(one_by_one, *samples)
    finally:
        torch.set_num_threads(threads)
    ratio = slow / quick
    record_property("ratio", ratio)
    per_step = f"{1e6 * quick / STEPS:.0f} and {1e6 * slow / STEPS:.0f} us a step of all five"
    print(f"\ntogether and one by one: {per_step}, ratio {ratio:.1f}")  # noqa: T201
    assert ratio > AT_LEAST
