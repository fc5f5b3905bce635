"""Error against the number of shots, method by method."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, cast

import numpy as np
from pydantic import Field

from gonio.directions import from_degrees
from gonio.errors import BadInputError
from gonio.files import sha256_bytes
from gonio.materials import MeasuredTable
from gonio.samples import Samples
from gonio.validation import Document
from nnbrdf.analytic_model import AnalyticCard
from nnbrdf.metrics import eps8, male
from nnbrdf.posterior_model import PosteriorCard
from nnbrdf.prior import MaterialPrior, Pairs
from nnbrdf.prior.family import grid_pairs
from nnbrdf.prior.generated import GeneratedMaterials
from nnbrdf.rows import read_rows, write_rows
from nnbrdf.studies.train import Truth

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from nnbrdf.load import Model, ModelCard

    Array = NDArray[np.float64]
    Evaluate = Callable[[Array, Array], Array]
    Method = Callable[[Samples, NDArray[np.int64]], tuple[Evaluate, int]]

METHODS = ("nn", "prior", "analytic", "paper", "pca-ridge", "nbrdf")
COUNTS = (8, 16, 32, 64, 128, 196, 1134, 6561)
_SIGMA = 0.003
_REMEDY = "delete it, or take another folder"
Count = Annotated[int, Field(ge=1)]
Error = Annotated[float, Field(ge=0)]
_UNSEEN = 5000
_OFF_GRID, _OFF_DEG = 100_000, 75.0


class Shot(Document):
    """One method on one number of shots.

    Attributes
    ----------
    material, sha256, method, shots
        Which; the hash is of the material's values and white.
    eps8, male
        Over the 81 x 81 grid.
    seconds
        From the samples to the values on the grid.
    numbers
        How many the method keeps of a material, such as weights; what it keeps a channel counts
        once for channels that are the same.
    channels
        How many different ones the material has.
    off_eps8, off_male
        At 100,000 random pairs up to 75 degrees; None of a material known on the grid only.
    """

    material: str
    sha256: str
    method: str
    shots: Count
    eps8: Error
    male: Error
    seconds: Error
    numbers: Count
    channels: Count
    off_eps8: Error | None = None
    off_male: Error | None = None

    @property
    def key(self) -> tuple[str, str, int]:
        """What it is of."""
        return self.sha256, self.method, self.shots


@dataclass(frozen=True)
class Drawn:
    """A generated material that the prior has not seen, grey.

    Attributes
    ----------
    seed
        Which of the anisotropic ones.
    """

    seed: int

    def evaluate(self, light: Array, view: Array) -> Array:
        """Return its values at unit vectors of shape (n, 3), shape (n, 3)."""
        drawn = GeneratedMaterials.draw(1, _UNSEEN + self.seed, isotropic=False)
        return np.repeat(drawn.evaluate(Pairs.of(light, view)), 3, axis=1)

    def truth(self) -> Truth:
        """Return its table, which knows the material between its nodes as well."""
        grid = grid_pairs()
        table = MeasuredTable.of(self.evaluate(grid.light, grid.view).reshape(81, 81, 3))
        digest = sha256_bytes(table.values.tobytes())
        return Truth(f"generated {self.seed}", digest, table.values, table.white, exact=self)


def methods(names: Sequence[str]) -> dict[str, Method]:
    """Return methods by name.

    Each takes samples and their rows of the grid; it returns what evaluates unit vectors of shape
    (n, 3), and how many numbers that is made of.

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown name.
    """
    from nnbrdf.baselines.nbrdf import WEIGHTS, fit_nbrdf
    from nnbrdf.baselines.pca_ridge import COMPONENTS, PcaRidge
    from nnbrdf.estimators import estimator_named

    prior = MaterialPrior.generate()

    def estimated(name: str, **settings: object) -> Method:
        def run(samples: Samples, rows: NDArray[np.int64]) -> tuple[Evaluate, int]:
            model = cast("Model", estimator_named(name)(**settings).fit(samples))
            return model.evaluate, _numbers(model.card, distinct_channels(samples.value))

        return run

    def regressed() -> Method:
        basis = PcaRidge(prior)

        def run(samples: Samples, rows: NDArray[np.int64]) -> tuple[Evaluate, int]:
            told = basis.reconstruct(rows, samples.value, samples.white)
            table = MeasuredTable.of(np.broadcast_to(told, (len(told), 3)).reshape(81, 81, 3))
            return table.evaluate, COMPONENTS * distinct_channels(samples.value)

        return run

    def trained() -> Method:
        return lambda samples, rows: (fit_nbrdf(samples), WEIGHTS)

    makers: dict[str, Callable[[], Method]] = {
        "nn": lambda: estimated("nn", prior=prior),
        "prior": lambda: estimated("prior", prior=prior),
        "analytic": lambda: estimated("analytic"),
        "paper": lambda: estimated("paper", steps=103_000),
        "pca-ridge": regressed,
        "nbrdf": trained,
    }
    unknown = [name for name in names if name not in makers]
    if unknown:
        raise BadInputError(f"method {unknown[0]!r} is not known; use {', '.join(METHODS)}")
    return {name: makers[name]() for name in names}


def run_shots(
    truths: Iterable[Truth],
    designs: Mapping[int, NDArray[np.int64]],
    methods: Mapping[str, Method],
    table: Path,
    progress: Callable[[int, int], None],
) -> list[Shot]:
    """Try every method on every number of shots; what the table holds already counts.

    Parameters
    ----------
    truths
        Materials.
    designs
        Rows of the flattened grid by number of shots.
    methods
        By name.
    table
        CSV, written anew after each result: an interrupted study goes on there.
    """
    done = {each.key: each for each in read_rows(table, Shot, _REMEDY)}
    wanted = [(truth, name, count) for truth in truths for count in designs for name in methods]
    for index, (truth, name, count) in enumerate(wanted):
        progress(index, len(wanted))
        if (truth.digest, name, count) not in done:
            shot = _try(truth, name, methods[name], designs[count])
            done[shot.key] = shot
            write_rows(table, Shot, done.values())
    progress(len(wanted), len(wanted))
    return [done[truth.digest, name, count] for truth, name, count in wanted]


def distinct_channels(values: Array) -> int:
    """Return how many channels, the last axis, are not the same as another."""
    return int(np.unique(values.reshape(-1, values.shape[-1]), axis=1).shape[1])


def _numbers(card: ModelCard, channels: int) -> int:
    """Return how many numbers a model keeps of a material with so many different channels."""
    if isinstance(card, PosteriorCard):
        return card.samples * channels
    if isinstance(card, AnalyticCard):
        return len(card.shape) + len(card.colors) * channels
    return card.weights


def _try(truth: Truth, name: str, method: Method, rows: NDArray[np.int64]) -> Shot:
    grid, value = grid_pairs(), truth.values.reshape(-1, 3)[rows]
    samples = Samples.from_values(grid.light[rows], grid.view[rows], value, sigma=_SIGMA * value)
    began = perf_counter()
    evaluate, numbers = method(samples, rows)
    told = evaluate(grid.light, grid.view)
    seconds = perf_counter() - began
    errors = _errors(told, truth.values.reshape(-1, 3), truth.white)
    off = _off_grid(evaluate, truth)
    return Shot(
        material=truth.name,
        sha256=truth.digest,
        method=name,
        shots=len(rows),
        eps8=errors[0],
        male=errors[1],
        seconds=seconds,
        numbers=numbers,
        channels=distinct_channels(truth.values),
        off_eps8=off[0],
        off_male=off[1],
    )


def _off_grid(evaluate: Evaluate, truth: Truth) -> tuple[float | None, float | None]:
    if truth.exact is None:
        return None, None
    rng = np.random.default_rng(0)
    light, view = (
        from_degrees(rng.uniform(0, _OFF_DEG, _OFF_GRID), rng.uniform(0, 360, _OFF_GRID))
        for _ in range(2)
    )
    return _errors(evaluate(light, view), truth.exact.evaluate(light, view), truth.white)


def _errors(told: Array, true: Array, white: float) -> tuple[float, float]:
    told = np.broadcast_to(told, true.shape)
    return eps8(told, true, white), male(told, true, white)
