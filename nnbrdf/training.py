"""Training of stacked networks, each on its own order of the same samples."""

from __future__ import annotations

import logging
from functools import cache
from time import perf_counter
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from gonio.errors import BadInputError, MissingExtraError
from nnbrdf import fused
from nnbrdf.history import Checkpoint

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.protocols import Progress
    from nnbrdf.network import Networks

_log = logging.getLogger(__name__)

BATCH = 32
CHECKPOINTS = 25
RATE = 0.0025
TRAINERS = ("fused", "torch", "cuda")
"""The compiled kernel, torch on the processor, torch on a GPU."""


class Trainer(Protocol):
    """Networks in training: `nnbrdf.fused.FusedTrainer`, `nnbrdf.batched.BatchedTrainer`."""

    def run(self, steps: int) -> None:
        """Take so many steps more."""

    def predict(self, inputs: NDArray[Any]) -> NDArray[Any]:
        """Return what the members say now, shape (members, n, outputs)."""

    def networks(self) -> Networks:
        """Return a copy of the members as they are now."""

    @property
    def diverged(self) -> NDArray[np.bool_]:
        """Which members have stopped since their gradient was not finite."""


def default_trainer() -> str:
    """Return `fused` where the kernel was compiled, else `torch`, and a warning once a process."""
    if fused.is_available():
        return "fused"
    _warn_of_torch()
    return "torch"


def make_trainer(
    networks: Networks,
    inputs: NDArray[np.float64],
    targets: NDArray[np.float64],
    seeds: Sequence[int],
    trainer: str | None = None,
    rate: float = RATE,
) -> Trainer:
    """Put networks into training: mean absolute error, Adamax, batches of 32.

    The last batch of an epoch may be smaller and counts as one step.

    Parameters
    ----------
    networks
        Where to start; its precision is the training's.
    inputs, targets
        Shapes (n, inputs) and (n, outputs).
    seeds
        One a member.
    trainer
        A name of `TRAINERS`; by default `fused` where it was compiled, else `torch`.
    rate
        Step size.

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown trainer, or one that this machine has not got.
    gonio.errors.MissingExtraError
        When torch is wanted and not installed.
    """
    name = trainer or default_trainer()
    if name not in TRAINERS:
        raise BadInputError(f"trainer {name!r} is not known; use {', '.join(TRAINERS)}")
    if name == "fused":
        return fused.FusedTrainer(networks, inputs, targets, seeds, rate)
    try:
        import torch

        from nnbrdf.batched import BatchedTrainer
    except ModuleNotFoundError as error:
        if error.name != "torch":
            raise
        raise MissingExtraError("torch", "nn") from None
    if name == "cuda" and not torch.cuda.is_available():
        raise BadInputError("trainer cuda finds no GPU here; use fused or torch")
    device = "cuda" if name == "cuda" else "cpu"
    return BatchedTrainer(networks, inputs, targets, seeds, rate, device)


@cache
def _warn_of_torch() -> None:
    _log.warning(
        "no compiled trainer here, so torch trains, some 40 times slower; for the other, "
        "install a C++ compiler and gonio again"
    )


def train(
    networks: Networks,
    inputs: NDArray[np.float64],
    targets: NDArray[np.float64],
    steps: int,
    seeds: Sequence[int],
    progress: Progress | None = None,
    trainer: str | None = None,
) -> list[Checkpoint]:
    """Train all members; each ends where it would have ended alone.

    Parameters
    ----------
    networks, inputs, targets, seeds, trainer
        As in `make_trainer`.
    steps
        Number of batches; an epoch may be left unfinished.
    progress
        Called with the steps done, about a hundred times.

    Returns
    -------
    list of Checkpoint
        At about 25 steps, spaced by equal ratios; the last is the end.
    """
    running = make_trainer(networks, inputs, targets, seeds, trainer)
    wanted = set(checkpoint_steps(steps))
    stops = sorted(wanted | set(range(0, steps, max(steps // 100, 1))[1:]))
    checkpoints, done, seconds = [], 0, 0.0
    for stop in stops:
        began = perf_counter()
        running.run(stop - done)
        seconds += perf_counter() - began
        done = stop
        if stop in wanted:
            checkpoints.append(_checkpoint(running, inputs, targets, stop, seconds))
        if progress is not None:
            progress(stop, steps)
    return checkpoints


def losses(outputs: NDArray[Any], targets: NDArray[Any]) -> NDArray[np.float64]:
    """Return the mean absolute error of each member in double precision, shape (members,).

    Parameters
    ----------
    outputs
        Shape (members, n, outputs); a member that diverged may have any, and its error is then
        not finite.
    targets
        Shape (n, outputs), or one for each member.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(np.abs(outputs.astype(np.float64) - targets).mean(axis=(1, 2)))


def epoch_steps(samples: int) -> int:
    """Return the steps of one epoch: batches of 32, the last partial one kept."""
    return -(-samples // BATCH)


def checkpoint_steps(steps: int) -> list[int]:
    """Return at most 25 rising steps from 1 to `steps`, spaced by about equal ratios."""
    return sorted({round(step) for step in np.geomspace(1, steps, CHECKPOINTS).tolist()})


def _checkpoint(
    running: Trainer,
    inputs: NDArray[np.float64],
    targets: NDArray[np.float64],
    step: int,
    seconds: float,
) -> Checkpoint:
    loss = losses(running.predict(inputs), targets)
    return Checkpoint(step, seconds, loss, running.networks(), running.diverged)
