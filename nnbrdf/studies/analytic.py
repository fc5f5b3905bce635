"""Models of the literature beside the networks: error, fitting time, evaluation time."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gonio.samples import Samples
from nnbrdf.encoding import INPUTS
from nnbrdf.ensemble import Ensemble, grid_pairs
from nnbrdf.fitting import fit_model
from nnbrdf.metrics import Scores, score
from nnbrdf.network import glorot_uniform
from nnbrdf.studies.job import METRICS
from nnbrdf.studies.tables import known_of, median_of
from nnbrdf.timing import million_seconds

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from nnbrdf.studies.job import Job, Outcome
    from nnbrdf.studies.train import Truth


@dataclass(frozen=True)
class Result:
    """One competitor on one subset.

    Attributes
    ----------
    name
        Of the model, or of the network's shape.
    subset
        What it was fitted to.
    numbers
        How many parameters or weights it has.
    scores
        Over the 81 x 81 grid; of networks the medians over the seeds, infinite where half or more
        diverged.
    fit_seconds
        What the fit took, or the training of one network.
    million_seconds
        Evaluating a million pairs in NumPy, on one core.
    """

    name: str
    subset: str
    numbers: int
    scores: Scores
    fit_seconds: float
    million_seconds: float

    def cells(self) -> dict[str, float | None]:
        """Return errors and times by the names of metrics; None where half or more diverged."""
        scores = {metric: known_of(getattr(self.scores, metric), metric) for metric in METRICS}
        seconds = known_of(self.fit_seconds, "fit_seconds")
        return scores | {"fit_seconds": seconds, "million_seconds": self.million_seconds}


def samples_of(truth: Truth, pairs: NDArray[np.int64]) -> Samples:
    """Return noise-free samples of a table at indices of the flattened grid."""
    light, view = (each.reshape(-1, 3)[pairs] for each in grid_pairs())
    return Samples.from_values(light, view, truth.values.reshape(-1, 3)[pairs])


def compare_model(name: str, truth: Truth, subset: str, pairs: NDArray[np.int64]) -> Result:
    """Fit a model of `nnbrdf.fitting` and judge it."""
    fit = fit_model(name, samples_of(truth, pairs))
    evaluate, numbers = fit.material.evaluate, len(fit.shape) + fit.colors.size
    scores = score(evaluate(*grid_pairs()), truth.values, truth.white)
    return Result(name, subset, numbers, scores, fit.seconds, million_seconds(evaluate))


def compare_networks(outcomes: Sequence[Outcome]) -> list[Result]:
    """Judge each network by the medians over its seeds; outcomes are of one material and subset."""
    groups: dict[Job, list[Outcome]] = defaultdict(list)
    for outcome in outcomes:
        groups[replace(outcome.job, seed=0)].append(outcome)
    return [_medians(job, group) for job, group in groups.items()]


def _medians(job: Job, outcomes: Sequence[Outcome]) -> Result:
    scores = Scores(*(median_of(outcomes, metric) for metric in METRICS))
    # how long a network takes hangs on its shape, not on its weights
    sizes, rng = (INPUTS[job.encoding], *job.hidden, 3), np.random.default_rng(0)
    network = Ensemble(glorot_uniform(sizes, [rng], activation=job.activation), job.encoding, 1.0)
    return Result(
        f"network {job.network}",
        job.subset,
        job.weights,
        scores,
        median_of(outcomes, "seconds"),
        million_seconds(network.predict),
    )
