"""A material at many pairs: a block at a time, so that memory stays bounded, and told."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.steps import Steps

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Material, Progress

_BLOCK = 1 << 14


def evaluate_in_blocks(
    material: Material,
    light: NDArray[np.float64],
    view: NDArray[np.float64],
    progress: Progress | None = None,
) -> NDArray[np.float64]:
    """Return the BRDF at n pairs in 1/sr, shape (n, 3); `light` and `view` are of shape (n, 3)."""
    result = np.empty((len(light), 3))
    starts = range(0, len(light), _BLOCK)
    step = Steps(len(starts), progress)
    for start in starts:
        part = slice(start, start + _BLOCK)
        result[part] = material.evaluate(light[part], view[part])
        step()
    return result
