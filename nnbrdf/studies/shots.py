"""Error against the number of shots, method by method."""

from __future__ import annotations

import csv
import math
from dataclasses import asdict, dataclass, fields
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadFileError, BadInputError
from gonio.files import write_bytes
from gonio.samples import Samples
from nnbrdf.metrics import eps8, male
from nnbrdf.prior import MaterialPrior
from nnbrdf.prior.family import grid_pairs

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from nnbrdf.studies.train import Truth

    Array = NDArray[np.float64]
    Method = Callable[[Samples, NDArray[np.int64]], Array]

METHODS = ("nn", "prior", "analytic", "paper", "pca-ridge", "nbrdf")
COUNTS = (8, 16, 32, 64, 128, 196, 1134, 6561)
_SIGMA = 0.003


@dataclass(frozen=True)
class Shot:
    """One method on one number of shots.

    Attributes
    ----------
    material, sha256, method, shots
        Which; the hash is of the material's values and white.
    eps8, male
        Over the 81 x 81 grid.
    seconds
        From the samples to the values on the grid.
    """

    material: str
    sha256: str
    method: str
    shots: int
    eps8: float
    male: float
    seconds: float

    @property
    def key(self) -> tuple[str, str, int]:
        """What it is of."""
        return self.sha256, self.method, self.shots


def methods(names: Sequence[str]) -> dict[str, Method]:
    """Return methods by name, each from samples and their rows of the grid to values on the grid.

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown name.
    """
    from nnbrdf.baselines import PcaRidge, fit_nbrdf
    from nnbrdf.estimators import estimator_named

    prior = MaterialPrior.generate()

    def estimated(name: str, **settings: object) -> Method:
        def run(samples: Samples, rows: NDArray[np.int64]) -> Array:
            model = estimator_named(name)(**settings).fit(samples)
            grid = grid_pairs()
            return model.evaluate(grid.light, grid.view)

        return run

    def regressed() -> Method:
        basis = PcaRidge(prior)
        return lambda samples, rows: basis.reconstruct(rows, samples.value, samples.white)

    makers: dict[str, Callable[[], Method]] = {
        "nn": lambda: estimated("nn", prior=prior),
        "prior": lambda: estimated("prior", prior=prior),
        "analytic": lambda: estimated("analytic"),
        "paper": lambda: estimated("paper", steps=103_000),
        "pca-ridge": regressed,
        "nbrdf": lambda: lambda samples, rows: fit_nbrdf(samples),
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
    done = {each.key: each for each in read_shots(table)}
    wanted = [(truth, name, count) for truth in truths for count in designs for name in methods]
    for index, (truth, name, count) in enumerate(wanted):
        progress(index, len(wanted))
        if (truth.digest, name, count) not in done:
            shot = _try(truth, name, methods[name], designs[count])
            done[shot.key] = shot
            write_shots(table, done.values())
    progress(len(wanted), len(wanted))
    return [done[truth.digest, name, count] for truth, name, count in wanted]


def read_shots(table: Path) -> list[Shot]:
    """Read what `write_shots` wrote; nothing where there is no file.

    Raises
    ------
    gonio.errors.BadFileError
        When it is something else.
    """
    if not table.exists():
        return []
    try:
        with table.open(newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file)
            rows = list(reader)
        if tuple(reader.fieldnames or ()) != _NAMES:
            raise ValueError("it has other columns")
        kinds = {"shots": int, "eps8": float, "male": float, "seconds": float}
        shots = [Shot(**{name: kinds.get(name, str)(row[name]) for name in _NAMES}) for row in rows]
        for line, shot in enumerate(shots, start=2):
            if not all(0 <= each < math.inf for each in (shot.eps8, shot.male, shot.seconds)):
                raise ValueError(f"line {line}: an error or a time is no number from 0")
        return shots
    except (OSError, ValueError, KeyError, TypeError, csv.Error) as error:
        remedy = "delete it, or take another folder"
        raise BadFileError(table, f"is no table of this study ({error})", remedy) from None


def write_shots(table: Path, shots: Iterable[Shot]) -> None:
    """Write one line a result, whole or not at all."""
    lines = [",".join(_NAMES)]
    lines += [",".join(str(value) for value in asdict(shot).values()) for shot in shots]
    write_bytes(table, ("\n".join(lines) + "\n").encode())


def _try(truth: Truth, name: str, method: Method, rows: NDArray[np.int64]) -> Shot:
    grid, value = grid_pairs(), truth.values.reshape(-1, 3)[rows]
    samples = Samples.from_values(grid.light[rows], grid.view[rows], value, sigma=_SIGMA * value)
    began = perf_counter()
    told = method(samples, rows)
    seconds = perf_counter() - began
    told = np.broadcast_to(told, (len(told), 3)).reshape(truth.values.shape)
    pair = (truth.values, truth.white)
    error, log_error = eps8(told, *pair), male(told, *pair)
    return Shot(truth.name, truth.digest, name, len(rows), error, log_error, seconds)


_NAMES = tuple(field.name for field in fields(Shot))
