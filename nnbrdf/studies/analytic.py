"""Models of the literature beside the networks: error, fitting time, evaluation time."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import median
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from gonio.samples import Samples
from nnbrdf.ensemble import Ensemble, grid_pairs
from nnbrdf.fitting import fit_model
from nnbrdf.metrics import score

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Material
    from nnbrdf.estimators import PaperEstimator
    from nnbrdf.metrics import Scores
    from nnbrdf.studies.train import Truth

TIMED_PAIRS = 100_000
_REPEATS = 3


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
        Over the 81 x 81 grid.
    fit_seconds
        What the fit took.
    million_seconds
        Evaluating a million pairs in NumPy, on one core.
    """

    name: str
    subset: str
    numbers: int
    scores: Scores
    fit_seconds: float
    million_seconds: float


def samples_of(truth: Truth, pairs: NDArray[np.int64]) -> Samples:
    """Return noise-free samples of a table at indices of the flattened grid."""
    light, view = (each.reshape(-1, 3)[pairs] for each in grid_pairs())
    return Samples.from_values(light, view, truth.values.reshape(-1, 3)[pairs])


def compare_model(name: str, truth: Truth, subset: str, pairs: NDArray[np.int64]) -> Result:
    """Fit a model of `nnbrdf.fitting` and judge it."""
    # else the first fit would be charged for the import
    import scipy.optimize
    import scipy.stats  # noqa: F401

    fit = fit_model(name, samples_of(truth, pairs))
    numbers = len(fit.shape) + fit.colors.size
    return _result(name, truth, subset, numbers, fit.material, fit.seconds)


def compare_network(
    recipe: PaperEstimator, truth: Truth, subset: str, pairs: NDArray[np.int64]
) -> Result:
    """Train the paper's recipe and judge the delivered network; one seed's share of the time."""
    model = recipe.fit(samples_of(truth, pairs))
    assert model.history is not None
    seconds = model.history.checkpoints[-1].seconds / recipe.members
    name = f"network {'-'.join(str(size) for size in recipe.hidden)}"
    # the delivered member alone, without the chunks that keep a model small in memory
    delivered = model.networks.member(model.card.delivered)
    member = _Delivered(Ensemble(delivered, model.card.encoding, model.card.white))
    return _result(name, truth, subset, model.card.weights, member, seconds)


@dataclass(frozen=True)
class _Delivered:
    ensemble: Ensemble

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        light, view = np.broadcast_arrays(light, view)
        said = self.ensemble.predict(light.reshape(-1, 3), view.reshape(-1, 3))[0].clip(0.0)
        return np.asarray(said.reshape(light.shape))


def _result(
    name: str, truth: Truth, subset: str, numbers: int, material: Material, seconds: float
) -> Result:
    light, view = grid_pairs()
    scores = score(material.evaluate(light, view), truth.values, truth.white)
    return Result(name, subset, numbers, scores, seconds, million_seconds(material))


def million_seconds(material: Material) -> float:
    """Return the seconds that a million random pairs take, from 100,000 of them."""
    rng = np.random.default_rng(0)
    vectors = rng.normal(size=(2, TIMED_PAIRS, 3))
    vectors[..., 2] = np.abs(vectors[..., 2])
    light, view = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    taken = []
    for _ in range(_REPEATS):
        began = perf_counter()
        material.evaluate(light, view)
        taken.append(perf_counter() - began)
    return median(taken) * 1e6 / TIMED_PAIRS
