"""Values on a regular grid of any number of axes, linear between its nodes."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.errors import BadFileError
from gonio.samples import LARGEST

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


class Place(NamedTuple):
    """Where positions lie on an axis: the nodes on both sides and the weight of the upper one."""

    low: NDArray[np.int64]
    high: NDArray[np.int64]
    weight: NDArray[np.float64]


def clamped(position: NDArray[np.float64], count: int) -> Place:
    """Place positions, in nodes from the first, on an axis that ends with its last node."""
    inside = position.clip(0.0, count - 1.0)
    low = np.minimum(inside.astype(np.int64), max(count - 2, 0))
    return Place(low, np.minimum(low + 1, count - 1), inside - low)


def periodic(position: NDArray[np.float64], count: int) -> Place:
    """Place positions on an axis whose first node follows its last."""
    low = np.floor(position).astype(np.int64)
    return Place(low % count, (low + 1) % count, position - low)


def between(position: NDArray[np.float64], nodes: NDArray[np.float64]) -> Place:
    """Place positions on an axis of uneven nodes, which ends with them."""
    if len(nodes) == 1:
        zero = np.zeros(position.shape, np.int64)
        return Place(zero, zero, np.zeros(position.shape))
    low = (np.searchsorted(nodes, position, side="right") - 1).clip(0, len(nodes) - 2)
    weight = (position - nodes[low]) / (nodes[low + 1] - nodes[low])
    return Place(low, low + 1, weight.clip(0.0, 1.0))


def multilinear(values: NDArray[np.float64], places: tuple[Place, ...]) -> NDArray[np.float64]:
    """Interpolate.

    Parameters
    ----------
    values
        Shape (nodes of each axis..., channels).
    places
        One an axis, of positions of shape (n,).

    Returns
    -------
    ndarray
        Shape (n, channels).
    """
    total = np.zeros((len(places[0].weight), values.shape[-1]))
    for corner in product((False, True), repeat=len(places)):
        nodes = tuple(p.high if up else p.low for p, up in zip(places, corner, strict=True))
        weight = np.ones(len(total))
        for place, up in zip(places, corner, strict=True):
            weight *= place.weight if up else 1.0 - place.weight
        total += weight[:, None] * values[nodes]
    return total


def check_finite(values: NDArray[np.float64], path: Path, what: str, remedy: str) -> None:
    """Refuse numbers that no reflectance has.

    Raises
    ------
    gonio.errors.BadFileError
        Naming how many of them there are, and the first.
    """
    bad = ~(np.abs(values) <= LARGEST)
    if bad.any():
        first = values[bad].flat[0]
        problem = f"{what} holds {np.count_nonzero(bad)} values like {first:g}, no reflectance"
        raise BadFileError(path, problem, remedy)
