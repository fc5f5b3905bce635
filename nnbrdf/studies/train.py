"""Carrying out a job: train one network, and hold it against the table it was drawn from."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from time import thread_time
from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.encoding import ENCODINGS, INPUTS
from nnbrdf.ensemble import grid_pairs
from nnbrdf.metrics import score
from nnbrdf.network import glorot_uniform
from nnbrdf.studies.job import Outcome
from nnbrdf.training import make_trainer

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from gonio.protocols import Material
    from nnbrdf.metrics import Scores
    from nnbrdf.studies.job import Job
    from nnbrdf.training import Trainer

_AT_ONCE = 500


@dataclass(frozen=True)
class Truth:
    """A table to learn.

    Attributes
    ----------
    name, digest
        Its name, and the SHA-256 of its values.
    values
        1/sr, shape (81, 81, 3), [light, view, channel].
    white
        Exposure scale of the error metrics, in 1/sr.
    exact
        The material itself, where it is known between the nodes, too.
    """

    name: str
    digest: str
    values: NDArray[np.float64]
    white: float
    exact: Material | None = None


def carry_out(
    job: Job,
    truth: Truth,
    subsets: Mapping[str, NDArray[np.int64]],
    tick: Callable[[int], None] = lambda steps: None,
) -> Outcome:
    """Train and judge one network.

    Parameters
    ----------
    job
        What to train.
    truth
        The table of `job.material`.
    subsets
        Pairs by name, as indices of the flattened 81 x 81 grid.
    tick
        Called with the steps taken since the last call, every few milliseconds of the kernel; what
        it raises ends the training.
    """
    inputs, pairs = _grid_inputs(job.encoding), subsets[job.subset]
    # the BRDF, in 1/sr, that a target of 1 stands for: the job's white becomes a target of `top`
    unit = truth.white * job.white_scale / job.top
    targets = np.clip(truth.values.reshape(-1, 3)[pairs] / unit, 0.0, job.top)
    running = _start(job, inputs[pairs], targets)
    seconds = _run(running, job.steps, tick)
    with np.errstate(over="ignore"):
        said = running.predict(inputs)[0].astype(np.float64) * unit
    if running.diverged[0] or not np.isfinite(said).all():
        return Outcome(job, seconds, diverged=True)
    loss = float(np.abs(said[pairs] / unit - targets).mean()) / job.top
    return _judged(
        job, seconds, loss, score(said.reshape(truth.values.shape), truth.values, truth.white)
    )


def _run(running: Trainer, steps: int, tick: Callable[[int], None]) -> float:
    """Take the steps; return the time of the processor that they took."""
    seconds = 0.0
    for begin in range(0, steps, _AT_ONCE):
        count = min(_AT_ONCE, steps - begin)
        began = thread_time()
        running.run(count)
        seconds += thread_time() - began
        tick(count)
    return seconds


def _start(job: Job, inputs: NDArray[np.float64], targets: NDArray[np.float64]) -> Trainer:
    """Put the network that the estimator's member of this number is into training."""
    generator = np.random.default_rng(np.random.SeedSequence(0, spawn_key=(job.seed,)))
    sizes = (INPUTS[job.encoding], *job.hidden, targets.shape[1])
    network = glorot_uniform(sizes, [generator], activation=job.activation)
    return make_trainer(network, inputs, targets, [int(generator.integers(2**63))], job.trainer)


def _judged(job: Job, seconds: float, loss: float, scores: Scores) -> Outcome:
    psnr = scores.sphere_psnr_db
    return Outcome(
        job,
        seconds,
        diverged=False,
        loss=loss,
        eps8=scores.eps8,
        male=scores.male,
        cube_root_rmse=scores.cube_root_rmse,
        sphere_psnr_db=psnr if math.isfinite(psnr) else None,
    )


@lru_cache
def _grid_inputs(encoding: str) -> NDArray[np.float64]:
    light, view = grid_pairs()
    return ENCODINGS[encoding](light.reshape(-1, 3), view.reshape(-1, 3))
