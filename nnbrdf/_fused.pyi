"""The compiled trainer, nnbrdf/kernel; it is absent where there was no compiler."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

class Trainer32:
    def __init__(
        self,
        layers: Sequence[NDArray[Any]],
        activation: int,
        inputs: NDArray[Any],
        targets: NDArray[Any],
        seed: int,
        rate: float,
        isa: str = "",
    ) -> None: ...
    def run(self, steps: int) -> int: ...
    def predict(self, inputs: NDArray[Any]) -> NDArray[Any]: ...
    def gradient(self, samples: NDArray[np.uint32]) -> list[NDArray[Any]]: ...
    @property
    def layers(self) -> list[NDArray[Any]]: ...
    @property
    def order(self) -> NDArray[np.uint32]: ...
    @property
    def step(self) -> int: ...
    @property
    def failed(self) -> bool: ...

class Trainer64(Trainer32): ...

def activate32(
    activation: int, totals: NDArray[Any], isa: str = ""
) -> tuple[NDArray[Any], NDArray[Any]]: ...
def activate64(
    activation: int, totals: NDArray[Any], isa: str = ""
) -> tuple[NDArray[Any], NDArray[Any]]: ...
def isas() -> list[str]: ...
