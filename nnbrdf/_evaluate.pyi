"""The compiled evaluation, nnbrdf/kernel; it is absent where there was no compiler."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

def evaluate32(
    layers: Sequence[NDArray[Any]],
    activation: int,
    encoding: int,
    scale: float,
    offset: float,
    tint: Sequence[float],
    light: NDArray[np.float32],
    view: NDArray[np.float32],
    values: NDArray[np.float32],
    isa: str = "",
) -> None: ...
def evaluate64(
    layers: Sequence[NDArray[Any]],
    activation: int,
    encoding: int,
    scale: float,
    offset: float,
    tint: Sequence[float],
    light: NDArray[np.float64],
    view: NDArray[np.float64],
    values: NDArray[np.float64],
    isa: str = "",
) -> None: ...
def isas() -> list[str]: ...
