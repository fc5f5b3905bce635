"""What evaluating a material takes."""

from __future__ import annotations

from statistics import median
from time import process_time
from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.cores import threads_for

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Evaluate = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]

_FEW, _MANY = 500, 100_000
_SLOW_SECONDS = 60.0
_REPEATS = 3


def million_seconds(evaluate: Evaluate) -> float:
    """Return the seconds that a million random pairs take one core, the median of three.

    From 100,000 pairs; from 500, where those tell that a million would take more than a minute.
    """
    rng = np.random.default_rng(0)
    vectors = rng.normal(size=(2, _MANY, 3))
    vectors[..., 2] = np.abs(vectors[..., 2])
    light, view = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    seconds = _per_million(evaluate, light[:_FEW], view[:_FEW])
    return seconds if seconds > _SLOW_SECONDS else _per_million(evaluate, light, view)


def _per_million(
    evaluate: Evaluate, light: NDArray[np.float64], view: NDArray[np.float64]
) -> float:
    taken = []
    with threads_for(1):
        for _ in range(_REPEATS):
            # of all threads: some evaluate in threads of their own
            began = process_time()
            evaluate(light, view)
            taken.append(process_time() - began)
    return median(taken) * 1e6 / len(light)
