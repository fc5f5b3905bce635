"""The compiled route search, planner/kernel; it is absent where there was no compiler."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

_Table = NDArray[np.int64]

class Metric:
    def __init__(
        self, view_go: _Table, view_run: _Table, light_go: _Table, light_run: _Table
    ) -> None: ...
    def override(self, starts: _Table, goals: _Table, times: _Table) -> None: ...

def search(
    metric: Metric,
    near: Metric,
    view_places: Sequence[Sequence[int]],
    light_places: Sequence[Sequence[int]],
    directions: _Table,
    poses: _Table,
    order: _Table,
    work: int,
    seed: int,
) -> tuple[_Table, _Table]: ...
def bound(near: Metric, directions: _Table, order: _Table) -> int: ...
