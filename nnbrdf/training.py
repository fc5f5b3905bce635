"""Training of stacked networks, each on its own order of the same samples; needs torch."""

from __future__ import annotations

from contextlib import contextmanager
from itertools import islice
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from nnbrdf.adamax import Adamax
from nnbrdf.gradient import Gradient, Parameters
from nnbrdf.history import Checkpoint

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from gonio.protocols import Progress
    from nnbrdf.network import Networks

BATCH = 32
CHECKPOINTS = 25


def train(
    networks: Networks,
    inputs: NDArray[np.float64],
    targets: NDArray[np.float64],
    steps: int,
    generators: Sequence[np.random.Generator],
    progress: Progress | None = None,
) -> list[Checkpoint]:
    """Train all members at once; each ends where it would have ended alone.

    Mean absolute error, Adamax, batches of 32; the last batch of an epoch may be smaller and
    counts as one step. One core, since the matrices are too small to share.

    Parameters
    ----------
    networks
        Where to start; its precision is the training's.
    inputs, targets
        Shapes (n, inputs) and (n, outputs).
    steps
        Number of batches; an epoch may be left unfinished.
    generators
        One a member, for the order of the samples in each epoch.
    progress
        Called with the steps done, about a hundred times.

    Returns
    -------
    list of Checkpoint
        At about 25 steps, spaced by equal ratios; the last is the end.
    """
    dtype = networks.layers[0].dtype
    with _one_thread(), torch.inference_mode():
        parameters = Parameters(networks)
        batches = islice(_batches(inputs.astype(dtype), targets.astype(dtype), generators), steps)
        recorder = _Recorder(parameters, inputs, targets, steps)
        for step in _descend(parameters, batches):
            recorder.after(step)
            if progress is not None and (step % max(steps // 100, 1) == 0 or step == steps):
                progress(step, steps)
        return recorder.checkpoints


def epoch_steps(samples: int) -> int:
    """Return the steps of one epoch: batches of 32, the last partial one kept."""
    return -(-samples // BATCH)


def checkpoint_steps(steps: int) -> list[int]:
    """Return at most 25 rising steps from 1 to `steps`, spaced by about equal ratios."""
    return sorted({round(step) for step in np.geomspace(1, steps, CHECKPOINTS).tolist()})


class _Recorder:
    """Keeps checkpoints; the time that it takes itself does not count."""

    def __init__(
        self,
        parameters: Parameters,
        inputs: NDArray[np.float64],
        targets: NDArray[np.float64],
        steps: int,
    ) -> None:
        self._parameters = parameters
        self._inputs, self._targets = inputs, targets
        self._wanted = set(checkpoint_steps(steps))
        self._start = perf_counter()
        self.checkpoints: list[Checkpoint] = []

    def after(self, step: int) -> None:
        if step not in self._wanted:
            return
        now = perf_counter()
        networks = self._parameters.networks()
        residual = networks.forward(self._inputs) - self._targets
        loss = np.abs(residual).mean(axis=(1, 2))
        self.checkpoints.append(Checkpoint(step, now - self._start, loss, networks))
        self._start += perf_counter() - now


def _descend(
    parameters: Parameters, batches: Iterator[tuple[torch.Tensor, torch.Tensor]]
) -> Iterator[int]:
    """Take one step a batch; yields how many have been taken."""
    adamax = Adamax(parameters.value, parameters.gradient)
    gradients: dict[int, Gradient] = {}
    for step, (inputs, targets) in enumerate(batches, start=1):
        size = inputs.shape[2]
        if size not in gradients:
            gradients[size] = Gradient(parameters, size)
        gradients[size].compute(inputs, targets)
        adamax.step()
        yield step


def _batches(
    inputs: NDArray[Any], targets: NDArray[Any], generators: Sequence[np.random.Generator]
) -> Iterator[tuple[torch.Tensor, torch.Tensor]]:
    """Yield batches without end, shapes (members, features, <= 32), each epoch in a new order."""
    count = len(inputs)
    ones = np.ones((1, count), inputs.dtype)
    columns = torch.from_numpy(np.concatenate([inputs.T, ones]))
    wanted = torch.from_numpy(np.ascontiguousarray(targets.T))
    while True:
        order = torch.from_numpy(np.stack([each.permutation(count) for each in generators]))
        shuffled = [rows[:, order].transpose(0, 1).contiguous() for rows in (columns, wanted)]
        for start in range(0, count, BATCH):
            x, y = (rows[:, :, start : start + BATCH] for rows in shuffled)
            yield x, y


@contextmanager
def _one_thread() -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)
