"""A density on the unit square, and the map that makes it uniform (Dupuy and Jakob 2018).

A slice is a density at nodes, linear between them in both coordinates. The second coordinate
follows the marginal distribution, the first the conditional one. Between slices of neighbouring
parameters density and cumulated sums are interpolated, not the map.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Slices(NamedTuple):
    """Which slices positions lie between, and their weights, shape (n, corners) each."""

    number: NDArray[np.int64]
    weight: NDArray[np.float64]


def alone(index: NDArray[np.int64]) -> Slices:
    """Return one slice for each position, shape (n,)."""
    return Slices(index[:, None], np.ones((len(index), 1)))


class Warp:
    """Warps of many slices.

    Parameters
    ----------
    density
        At nodes, not negative, shape (slices, height, width); scaled to an integral of one.
    """

    def __init__(self, density: NDArray[np.floating]) -> None:
        data = np.asarray(density, np.float64)
        self._within = _cumulated(data, axis=2)
        totals = self._within[:, :, -1]
        self._marginal = _cumulated(totals[:, None, :], axis=2)[:, 0]
        # a slice that is black throughout has no scale
        scale = np.where(self._marginal[:, -1] > 0, self._marginal[:, -1], 1.0)
        self._data = data / scale[:, None, None]
        self._within = self._within / scale[:, None, None]
        self._marginal = self._marginal / scale[:, None]
        self._height, self._width = data.shape[1:]

    def invert(
        self, place: NDArray[np.float64], slices: Slices
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return where a uniform square's positions come to lie: the way from density to uniform.

        Parameters
        ----------
        place
            Positions under the density, shape (n, 2), in [0, 1].
        slices
            Of each.

        Returns
        -------
        tuple of ndarray
            Positions in the uniform square, shape (n, 2), and the density there, shape (n,).
        """
        size = np.array([self._width - 1, self._height - 1])
        at = place.clip(0.0, 1.0) * size
        column, row = np.minimum(at.astype(np.int64), size - 1).T
        x, y = at[:, 0] - column, at[:, 1] - row

        def mixed(array: NDArray[np.float64], *where: NDArray[np.int64]) -> NDArray[np.float64]:
            taken = array[(slices.number, *(each[:, None] for each in where))]
            total: NDArray[np.float64] = (slices.weight * taken).sum(axis=1)
            return total

        left = (1 - y) * mixed(self._data, row, column) + y * mixed(self._data, row + 1, column)
        right = (1 - y) * mixed(self._data, row, column + 1) + y * mixed(
            self._data, row + 1, column + 1
        )
        before = (1 - y) * mixed(self._within, row, column) + y * mixed(
            self._within, row + 1, column
        )
        last = np.full(len(row), self._width - 1)
        low, high = mixed(self._within, row, last), mixed(self._within, row + 1, last)
        whole = (1 - y) * low + y * high
        along = before + x * (left + 0.5 * x * (right - left))
        # a row without any density is as good as a uniform one
        first = np.where(whole > 0, along / np.where(whole > 0, whole, 1.0), place[:, 0])
        second = mixed(self._marginal, row) + y * (low + 0.5 * y * (high - low))
        density = ((1 - x) * left + x * right) * size.prod()
        return np.stack([first, second], axis=1).clip(0.0, 1.0), density

    def nodes(self, index: int, size: int) -> NDArray[np.float64]:
        """Return where `size` x `size` nodes of the uniform square come from.

        Parameters
        ----------
        index
            Of the slice.
        size
            Nodes along each side.

        Returns
        -------
        ndarray
            Positions under the density, shape (size, size, 2); the first index is of the second
            coordinate.
        """
        wanted = np.linspace(0.0, 1.0, size)
        totals = self._within[index, :, -1]
        row, y = _solve(self._marginal[index], totals, wanted)
        result = np.empty((size, size, 2))
        result[:, :, 1] = ((row + y) / (self._height - 1))[:, None]
        for i, (r, part) in enumerate(zip(row, y, strict=True)):
            within, data = (
                (1 - part) * array[index, r] + part * array[index, r + 1]
                for array in (self._within, self._data)
            )
            column, x = _solve(within, data, wanted * within[-1])
            result[i, :, 0] = (column + x) / (self._width - 1)
        return result


def _cumulated(values: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    """Return the integrals from the first node to each, at a distance of 1 from node to node."""
    steps = 0.5 * (values[..., 1:] + values[..., :-1])
    total: NDArray[np.float64] = np.cumsum(steps, axis=axis)
    return np.concatenate([np.zeros((*values.shape[:-1], 1)), total], axis=axis)


def _solve(
    cumulated: NDArray[np.float64], density: NDArray[np.float64], wanted: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the interval, and the part of it, up to which the integral is as wanted."""
    cell = (np.searchsorted(cumulated, wanted, side="right") - 1).clip(0, len(cumulated) - 2)
    rest = np.maximum(wanted - cumulated[cell], 0.0)
    low, slope = density[cell], density[cell + 1] - density[cell]
    # the root of rest = x (low + x slope / 2) in the form that does not cancel
    root = np.sqrt(np.maximum(low**2 + 2.0 * slope * rest, 0.0))
    divisor = low + root
    part = np.where(divisor > 0, 2.0 * rest / np.where(divisor > 0, divisor, 1.0), 0.0)
    return cell, part.clip(0.0, 1.0)
