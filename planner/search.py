"""Searching pairs, and products of lights and views, for those that tell most."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.steps import Steps
from planner.pairing import may_join

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from gonio.protocols import Progress
    from planner.information import Unknown

    Array = NDArray[np.float64]

_FRESH = 64
"""Steps after which round-off is swept out."""
_WORTH = 1e-9
"""Share of the best gain that an exchange must bring, so that round-off exchanges nothing."""


class Measure(NamedTuple):
    """What a criterion calls gain.

    Attributes
    ----------
    alone
        Gains of all pairs, each alone, shape (pairs,), of one kind of material.
    block
        Gains of blocks of pairs (see `planner.information.Unknown.block_gains`).
    """

    alone: Callable[[Unknown], Array]
    block: Callable[[Unknown, NDArray[np.int64], NDArray[np.bool_]], Array]


def best_pairs(
    kinds: Sequence[Unknown],
    allowed: NDArray[np.bool_],
    count: int,
    measure: Measure,
    sweeps: int = 2,
    progress: Progress | None = None,
) -> NDArray[np.int64]:
    """Choose `count` pairs one after the other, then exchange each for the best there is.

    Pairs that all kinds take for equal, as by reciprocity, are taken once; only when each has been
    taken do others follow.

    Parameters
    ----------
    kinds
        Fresh; they have learned the choice afterwards.
    allowed
        Which pairs may be chosen, shape (pairs,), at least `count`.
    measure
        What counts as gain.
    sweeps
        How often all pairs are exchanged in turn, unless none moves before.
    progress
        Called with the steps done and those there may be.

    Returns
    -------
    ndarray
        Pairs in the order of their choice, shape (count,).
    """
    search = _PairSearch(kinds, allowed, measure, Steps(count * (1 + sweeps), progress))
    for _ in range(count):
        search.add()
    for _ in range(sweeps):
        if not search.exchange():
            break
    return np.array(search.chosen, np.int64)


class _PairSearch:
    """A set of pairs in the making."""

    def __init__(
        self,
        kinds: Sequence[Unknown],
        allowed: NDArray[np.bool_],
        measure: Measure,
        steps: Steps,
    ) -> None:
        self.kinds, self.measure, self.steps = kinds, measure, steps
        self.chosen: list[int] = []
        self._allowed = allowed
        self._classes = classes_of(kinds)
        self._taken = np.zeros(self._classes.max() + 1, np.int64)
        self._steps = 0

    def add(self) -> None:
        free = self._free()
        self.steps()
        self._turn(int(np.argmax(np.where(free, self._gains(), -np.inf))), known=True)

    def exchange(self) -> bool:
        """Take each pair out in turn and put the best there is in; return whether any has moved."""
        moved = False
        for pair in list(self.chosen):
            self.steps()
            self._turn(pair, known=False)
            gain = np.where(self._free(), self._gains(), -np.inf)
            best = int(np.argmax(gain))
            if gain[best] <= gain[pair] * (1 + _WORTH):
                best = pair
            self._turn(best, known=True)
            moved |= best != pair
        return moved

    def _free(self) -> NDArray[np.bool_]:
        untaken = self._allowed.copy()
        untaken[self.chosen] = False
        once = untaken & (self._taken == 0)[self._classes]
        return once if once.any() else untaken

    def _gains(self) -> Array:
        return np.asarray(sum(self.measure.alone(kind) for kind in self.kinds))

    def _turn(self, pair: int, *, known: bool) -> None:
        self._taken[self._classes[pair]] += 1 if known else -1
        self.chosen.append(pair) if known else self.chosen.remove(pair)
        self._steps += 1
        for kind in self.kinds:
            if self._steps % _FRESH:
                kind.turn(pair, known=known)
            else:
                kind.forget(np.array(self.chosen, np.int64))


def classes_of(kinds: Sequence[Unknown]) -> NDArray[np.int64]:
    """Return a number a pair, shape (pairs,), equal for pairs that all kinds take for equal."""
    classes = kinds[0].which
    for kind in kinds[1:]:
        joint = classes.astype(np.int64) * (int(kind.which.max()) + 1) + kind.which
        classes = np.unique(joint, return_inverse=True)[1].reshape(-1)
    return np.asarray(classes)


def best_product(
    kinds: Sequence[Unknown],
    allowed: NDArray[np.bool_],
    lights: int,
    views: int,
    measure: Measure,
    sweeps: int = 3,
    progress: Progress | None = None,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Choose `lights` rows and `views` columns whose pairs together tell most.

    They grow side by side, then each is exchanged in turn for the best there is until none moves.

    Parameters
    ----------
    kinds
        Fresh, over the pairs of `allowed` in its order.
    allowed
        Which pairs can be measured, shape (light candidates, view candidates).
    measure
        What counts as gain.
    progress
        Called with the steps done and those there may be.

    Returns
    -------
    tuple of ndarray
        Rising indices of lights and of views.
    """
    steps = Steps((lights + views) * (1 + sweeps), progress)
    search = _ProductSearch(kinds, allowed, measure, steps)
    search.grow(lights, views)
    for _ in range(sweeps):
        if not search.exchange():
            break
    return np.sort(search.chosen[0]), np.sort(search.chosen[1])


class _ProductSearch:
    """A product in the making; axis 0 are lights, axis 1 views."""

    def __init__(
        self,
        kinds: Sequence[Unknown],
        allowed: NDArray[np.bool_],
        measure: Measure,
        steps: Steps,
    ) -> None:
        self.kinds, self.allowed, self.measure, self.steps = kinds, allowed, measure, steps
        self.pairs = np.arange(allowed.size).reshape(allowed.shape)
        self.chosen: list[list[int]] = [[], []]
        self.wanted = (0, 0)

    def grow(self, lights: int, views: int) -> None:
        alone = sum(self.measure.alone(kind) for kind in self.kinds)
        first = np.where(self.allowed, np.reshape(alone, self.allowed.shape), -np.inf)
        light, view = np.unravel_index(int(np.argmax(first)), first.shape)
        self.chosen = [[int(light)], [int(view)]]
        self._learn(self._measured())
        self.wanted = (lights, views)
        while self.wanted != (len(self.chosen[0]), len(self.chosen[1])):
            short = [len(each) / want for each, want in zip(self.chosen, self.wanted, strict=True)]
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
        self.steps()
        others = self.chosen[1 - axis]
        if axis == 0:
            blocks, counted = self.pairs[:, others], self.allowed[:, others]
        else:
            blocks, counted = self.pairs[others].T, self.allowed[others].T
        gain = np.asarray(sum(self.measure.block(kind, blocks, counted) for kind in self.kinds))
        chosen = (self.chosen[0], self.chosen[1])
        gain[~may_join(self.allowed, chosen, self.wanted, axis)] = -np.inf
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
