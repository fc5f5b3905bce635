"""The compiled kernel for pixels, gonio/kernel; it is absent where there was no compiler."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

_Floats = NDArray[np.float32]
_Frame = tuple[NDArray[np.uint16], _Floats, float, float, Sequence[float]]

def merge(
    bracket: Sequence[_Frame],
    response: _Floats | None,
    coefficients: Sequence[float],
    raw_range: float,
    reach: float,
    gain: float,
    saturation: float,
) -> tuple[_Floats, _Floats]: ...

class Texels:
    def __init__(
        self,
        value: _Floats,
        variance: _Floats,
        channels: Sequence[int],
        rays: Sequence[float],
        camera: Sequence[float],
        lens: Sequence[float] | None,
        first_and_pitch: Sequence[float],
        side_and_parts: Sequence[int],
    ) -> None: ...
    def rows(self, first: int, last: int) -> tuple[_Floats, _Floats]: ...
    def develop(
        self,
        rate: Sequence[float],
        relative: Sequence[float],
        matrix: Sequence[float],
        even: _Floats,
        brdf: _Floats,
        sigma: NDArray[np.uint16],
    ) -> None: ...
