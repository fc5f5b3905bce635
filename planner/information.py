"""Which pairs of directions tell most: least posterior variance under a prior, integrated."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.protocols import PriorKind

    Array = NDArray[np.float64]

NOISE = 0.01
"""Variance of one measurement in the log domain: a tenth of its value, model error included."""


class Unknown:
    """What is still unknown of one kind of material, as pairs are measured.

    A measurement's gain is the sum over all pairs of the squared covariance with it, over its own
    variance: what it takes off the integrated variance (I-optimality; Fedorov 1972, chapter 2).

    Parameters
    ----------
    kind
        Its prior covariance at all pairs.
    """

    def __init__(self, kind: PriorKind) -> None:
        self._which = kind.which
        self._factor = kind.factor
        times = np.bincount(kind.which, minlength=len(kind.factor))
        self._scatter = (self._factor.T * times) @ self._factor
        self._share = kind.share / float(np.trace(self._scatter))
        self.forget(np.empty(0, np.int64))

    def forget(self, measured: NDArray[np.int64]) -> None:
        """Start again, knowing only the pairs `measured`."""
        rows = self._factor[self._which[measured]]
        precision = np.eye(rows.shape[1]) + rows.T @ rows / NOISE
        covariance = np.linalg.inv(precision)
        self._reach = self._factor @ covariance
        self._effect = self._reach @ self._scatter
        self._left = float(np.einsum("ij,ji->", covariance, self._scatter))

    @property
    def remaining(self) -> float:
        """Integrated variance left, as a share of the prior's, times the kind's own share."""
        return self._share * self._left

    def gains(self) -> Array:
        """Return what measuring each pair alone would take off, shape (pairs,)."""
        variance = np.einsum("ij,ij->i", self._reach, self._factor)
        effect = np.einsum("ij,ij->i", self._reach, self._effect)
        return np.asarray(self._share * effect / (variance + NOISE))[self._which]

    def block_gains(self, blocks: NDArray[np.int64], counted: NDArray[np.bool_]) -> Array:
        """Return what measuring each block of pairs at once would take off.

        Parameters
        ----------
        blocks
            Pairs of each block, shape (blocks, m).
        counted
            Which of them can be measured, shape (blocks, m).
        """
        rows = self._which[blocks]
        reach = self._reach[rows] * counted[..., None]
        inner = reach @ np.swapaxes(self._factor[rows] * counted[..., None], 1, 2)
        inner += NOISE * np.eye(blocks.shape[1])
        effect = reach @ np.swapaxes(self._effect[rows], 1, 2)
        gain = np.trace(np.linalg.solve(inner, effect), axis1=1, axis2=2)
        return np.asarray(self._share * gain)

    def learn(self, measured: NDArray[np.int64]) -> None:
        """Take in measurements of a few pairs."""
        rows = self._which[measured]
        reach = self._reach[rows]
        inner = self._factor[rows] @ reach.T + NOISE * np.eye(len(rows))
        gain = np.linalg.solve(inner, reach)
        moved = self._factor @ reach.T
        self._left -= float(np.trace(np.linalg.solve(inner, reach @ self._effect[rows].T)))
        self._effect = self._effect - moved @ (gain @ self._scatter)
        self._reach = self._reach - moved @ gain


def best_pairs(
    kinds: Sequence[Unknown], allowed: NDArray[np.bool_], count: int
) -> NDArray[np.int64]:
    """Choose `count` pairs one after the other, each for what it adds to those before it.

    Parameters
    ----------
    kinds
        Fresh; they have learned the choice afterwards.
    allowed
        Which pairs may be chosen, shape (pairs,).
    """
    chosen: list[int] = []
    free = allowed.copy()
    for _ in range(count):
        gain = np.where(free, sum(each.gains() for each in kinds), -np.inf)
        best = int(np.argmax(gain))
        chosen.append(best)
        free[best] = False
        for kind in kinds:
            kind.learn(np.array([best]))
    return np.array(chosen, np.int64)


def best_product(
    kinds: Sequence[Unknown], allowed: NDArray[np.bool_], lights: int, views: int, sweeps: int = 3
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Choose `lights` rows and `views` columns whose pairs together leave the least variance.

    They grow side by side, then each is exchanged in turn for the best there is until none moves.

    Parameters
    ----------
    kinds
        Fresh, over the pairs of `allowed` in its order.
    allowed
        Which pairs can be measured, shape (light candidates, view candidates).

    Returns
    -------
    tuple of ndarray
        Rising indices of lights and of views.
    """
    search = _ProductSearch(kinds, allowed)
    search.grow(lights, views)
    for _ in range(sweeps):
        if not search.exchange():
            break
    return np.sort(search.chosen[0]), np.sort(search.chosen[1])


class _ProductSearch:
    """A product in the making; axis 0 are lights, axis 1 views."""

    def __init__(self, kinds: Sequence[Unknown], allowed: NDArray[np.bool_]) -> None:
        self.kinds, self.allowed = kinds, allowed
        self.pairs = np.arange(allowed.size).reshape(allowed.shape)
        self.chosen: list[list[int]] = [[], []]

    def grow(self, lights: int, views: int) -> None:
        first = np.where(self.allowed, self._sum_gains().reshape(self.allowed.shape), -np.inf)
        light, view = np.unravel_index(int(np.argmax(first)), first.shape)
        self.chosen = [[int(light)], [int(view)]]
        self._learn(self._measured())
        wanted = (lights, views)
        while any(len(chosen) < want for chosen, want in zip(self.chosen, wanted, strict=True)):
            short = [len(chosen) / want for chosen, want in zip(self.chosen, wanted, strict=True)]
            self._add(int(np.argmin(short)))

    def exchange(self) -> bool:
        """Take each direction out and put the best one in; return whether any has changed."""
        moved = False
        for axis in (0, 1):
            if len(self.chosen[axis]) == self.allowed.shape[axis]:
                continue
            for index in list(self.chosen[axis]):
                self.chosen[axis].remove(index)
                for kind in self.kinds:
                    kind.forget(self._measured())
                moved |= self._add(axis) != index
        return moved

    def _add(self, axis: int) -> int:
        others = self.chosen[1 - axis]
        blocks, counted = self.pairs[:, others], self.allowed[:, others]
        if axis == 1:
            blocks, counted = self.pairs[others].T, self.allowed[others].T
        gain = sum(kind.block_gains(blocks, counted) for kind in self.kinds)
        gain = np.asarray(gain)
        gain[self.chosen[axis]] = -np.inf
        best = int(np.argmax(gain))
        self.chosen[axis].append(best)
        self._learn(blocks[best][counted[best]])
        return best

    def _measured(self) -> NDArray[np.int64]:
        grid = np.ix_(*self.chosen)
        return np.asarray(self.pairs[grid][self.allowed[grid]])

    def _learn(self, measured: NDArray[np.int64]) -> None:
        for kind in self.kinds:
            kind.learn(measured)

    def _sum_gains(self) -> Array:
        return np.asarray(sum(kind.gains() for kind in self.kinds))
