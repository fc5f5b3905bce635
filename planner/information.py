"""What pairs of directions tell: the posterior variance that they leave under a prior."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from gonio.protocols import PriorKind

    Array = NDArray[np.float64]

NOISE = 0.01
"""Variance of one measurement in the log domain: a tenth of its value, model error included."""

_CHUNK = 4_000_000
"""Numbers that one step works on at once: what it makes stays in memory, not on the disk."""


class Unknown:
    """What is still unknown of one kind of material, as pairs are measured.

    With the factor F of the prior's covariance and the scatter S = F.T diag(demand) F, everything
    is told by two matrices of the factor's rank: the covariance C = (1 + F_m.T F_m / noise)^-1 of
    the measured rows, and C S C. A measurement's gain is what it takes off the integrated
    variance trace(S C): f.T C S C f / (f.T C f + noise) (I-optimality; Fedorov 1972, chapter 2).
    What the factor leaves out of the prior's variance is told of measured pairs alone (as Snelson
    and Ghahramani 2006 do), and adds to what remains.

    Parameters
    ----------
    kind
        Its prior covariance at all pairs.
    demand
        How much each pair counts in the integral, shape (pairs,); None: all alike.

    Attributes
    ----------
    which
        Which of the pairs that differ each pair is, shape (pairs,).
    whole
        The prior's integrated variance.
    share
        What a unit of integrated variance counts: the kind's share over `whole`.
    """

    def __init__(self, kind: PriorKind, demand: Array | None = None) -> None:
        self.which = kind.which
        self._factor = kind.factor
        self._rest = np.zeros(len(kind.factor)) if kind.rest is None else kind.rest
        self._covariance = self._middle = np.empty((0, 0))
        self._left = 0.0
        self._times = np.zeros(len(kind.factor))
        self._variance: Array | None = None
        self._effect: Array | None = None
        counts = np.asarray(
            np.bincount(kind.which, weights=demand, minlength=len(kind.factor)), np.float64
        )
        self._scatter = np.zeros((kind.factor.shape[1],) * 2)
        for rows, factor in self._chunks():
            self._scatter += (factor.T * counts[rows]) @ factor
        self._counts = counts
        self.whole = float(np.trace(self._scatter) + counts @ self._rest)
        self.share = kind.share / self.whole if self.whole > 0 else 0.0
        self.forget(np.empty(0, np.int64))

    def forget(self, measured: NDArray[np.int64]) -> None:
        """Start again, knowing only the pairs `measured`."""
        times = np.bincount(self.which[measured], minlength=len(self._rest))
        self._times = np.asarray(times, np.float64)
        rows = self._rows(measured)
        precision = np.eye(rows.shape[1]) + rows.T @ rows / NOISE
        self._know(np.asarray(np.linalg.inv(precision), np.float64))

    def weigh(self, weights: Array) -> None:
        """Start again, each pair measured with a weight, shape (pairs,): 0 not at all, 1 once."""
        counts = np.asarray(
            np.bincount(self.which, weights=weights, minlength=len(self._factor)), np.float64
        )
        self._times = counts
        # most pairs have no weight
        some = np.flatnonzero(counts)
        rows = np.asarray(self._factor[some], np.float64)
        precision = np.eye(rows.shape[1]) + (rows.T * (counts[some] / NOISE)) @ rows
        self._know(np.asarray(np.linalg.inv(precision), np.float64))

    def learn(self, measured: NDArray[np.int64]) -> None:
        """Take in measurements of a few pairs."""
        np.add.at(self._times, self.which[measured], 1.0)
        rows = self._rows(measured)
        reach = rows @ self._covariance
        inner = rows @ reach.T + NOISE * np.eye(len(rows))
        self._know(self._covariance - reach.T @ np.linalg.solve(inner, reach))

    def turn(self, pair: int, *, known: bool) -> None:
        """Take in the measurement of one pair, or take it out again, in the time of two products.

        The gains of all pairs are kept up to date by the same rank-one step (Sherman and Morrison
        1950); a long row of steps gathers round-off, so `forget` now and then.
        """
        variance, effect = self._spreads()
        row = self._rows(np.array([pair]))[0]
        reach = self._covariance @ row
        over = float(row @ reach) + (NOISE if known else -NOISE)
        through = self._middle @ row
        size = float(reach @ self._scatter @ reach)
        both = np.stack([reach, through], axis=1).astype(self._factor.dtype)
        seen, told = (self._factor @ both).T
        variance -= seen**2 / over
        effect += seen * (seen * (size / over) - 2 * told) / over
        square, cross = np.outer(reach, reach), np.outer(reach, through)
        self._covariance = self._covariance - square / over
        self._middle = self._middle - (cross + cross.T - square * (size / over)) / over
        self._left -= size / over
        self._times[self.which[pair]] += 1.0 if known else -1.0

    @property
    def remaining(self) -> float:
        """Integrated variance left, as a share of the prior's, times the kind's own share."""
        rest = self._rest * NOISE / (self._times * self._rest + NOISE)
        return self.share * (self._left + float(self._counts @ rest))

    def gains(self) -> Array:
        """Return what measuring each pair alone would take off, shape (pairs,)."""
        variance, effect = self._spreads()
        return np.asarray(self.share * effect / (variance + NOISE))[self.which]

    def slopes(self) -> Array:
        """Return by how much a little more weight on each pair would lower `remaining`, (pairs,).

        Its derivative for the weights of `weigh`, negated.
        """
        _, effect = self._spreads()
        own = self._counts * NOISE * (self._rest / (self._times * self._rest + NOISE)) ** 2
        return np.asarray(self.share * (effect / NOISE + own))[self.which]

    def entropy_gains(self) -> Array:
        """Return by how much each pair alone would lower the log determinant, shape (pairs,)."""
        variance, _ = self._spreads()
        return np.log1p(variance / NOISE)[self.which]

    def block_gains(self, blocks: NDArray[np.int64], counted: NDArray[np.bool_]) -> Array:
        """Return what measuring each block of pairs at once would take off.

        Parameters
        ----------
        blocks
            Pairs of each block, shape (blocks, m).
        counted
            Which of them can be measured, shape (blocks, m).
        """
        return self.share * self._by_block(blocks, counted, self._block_gain)

    def block_entropy_gains(self, blocks: NDArray[np.int64], counted: NDArray[np.bool_]) -> Array:
        """Return by how much each block would lower the log determinant (see `block_gains`)."""
        return self._by_block(blocks, counted, self._block_entropy)

    def _by_block(
        self,
        blocks: NDArray[np.int64],
        counted: NDArray[np.bool_],
        gain: Callable[[Array], Array],
    ) -> Array:
        step = max(1, _CHUNK // (blocks.shape[1] * self._factor.shape[1]))
        parts = []
        for start in range(0, len(blocks), step):
            part = slice(start, start + step)
            rows = self._rows(blocks[part].ravel()).reshape(*blocks[part].shape, -1)
            parts.append(gain(rows * counted[part][..., None]))
        return np.concatenate(parts) if parts else np.empty(0)

    def _block_gain(self, rows: Array) -> Array:
        inner = self._inner(rows)
        effect = rows @ self._middle @ np.swapaxes(rows, 1, 2)
        return np.asarray(np.trace(np.linalg.solve(inner, effect), axis1=1, axis2=2))

    def _block_entropy(self, rows: Array) -> Array:
        return np.asarray(np.linalg.slogdet(self._inner(rows) / NOISE)[1])

    def _inner(self, rows: Array) -> Array:
        inner = rows @ self._covariance @ np.swapaxes(rows, 1, 2)
        return np.asarray(inner + NOISE * np.eye(rows.shape[1]))

    def _know(self, covariance: Array) -> None:
        self._covariance = 0.5 * (covariance + covariance.T)
        self._middle = self._covariance @ self._scatter @ self._covariance
        self._left = float(np.einsum("ij,ji->", self._covariance, self._scatter))
        self._variance = self._effect = None

    def _spreads(self) -> tuple[Array, Array]:
        """Return each different pair's variance and what its measurement reaches, kept."""
        if self._variance is None or self._effect is None:
            self._variance = np.empty(len(self._factor))
            self._effect = np.empty(len(self._factor))
            for rows, factor in self._chunks():
                self._variance[rows] = np.einsum("ij,ij->i", factor @ self._covariance, factor)
                self._effect[rows] = np.einsum("ij,ij->i", factor @ self._middle, factor)
        return self._variance, self._effect

    def _rows(self, pairs: NDArray[np.int64]) -> Array:
        return np.asarray(self._factor[self.which[pairs]], np.float64)

    def _chunks(self) -> Iterator[tuple[slice, Array]]:
        step = max(1, _CHUNK // self._factor.shape[1])
        for start in range(0, len(self._factor), step):
            rows = slice(start, start + step)
            yield rows, np.asarray(self._factor[rows], np.float64)
