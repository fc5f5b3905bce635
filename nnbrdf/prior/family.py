"""One kind of material that a sample may be: mean and covariance of its logarithm, at any pairs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.directions import paper_directions
from nnbrdf.prior.geometry import Pairs
from nnbrdf.prior.kernels import (
    ANISOTROPIC_SCALES,
    ISOTROPIC_SCALES,
    anisotropic_features,
    exchange,
    exchange_variance,
    isotropic_features,
    matern,
)
from nnbrdf.prior.log import OFFSET

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from nnbrdf.prior.generated import GeneratedMaterials
    from nnbrdf.prior.learned import LearnedMaterial

    Array = NDArray[np.float64]

_NOTHING = 1e-10
EXPOSURE = 1.0
"""Variance of the logarithm of a material's scale, which the examples do not tell."""
_AS_MANY = 10


class Traits(NamedTuple):
    """What a family knows of some pairs.

    Attributes
    ----------
    examples
        Each example's logarithm less their mean, times the root of its weight, at the pairs that
        differ in the family's eyes, shape (distinct, examples).
    distinct_mean
        Weighted mean of the examples' logarithms, shape (distinct,).
    which
        Which of these each pair is, shape (n,).
    features
        Where the pairs lie for the smooth deviation, shape (n, features).
    pairs
        The pairs themselves, n of them.
    """

    examples: Array
    distinct_mean: Array
    which: NDArray[np.int64]
    features: Array
    pairs: Pairs

    @property
    def mean(self) -> Array:
        """Prior mean at each pair, shape (n,)."""
        return self.distinct_mean[self.which]

    def part(self, rows: slice | NDArray[np.int64]) -> Traits:
        """Return the traits of some of the pairs."""
        which = self.which[rows]
        kept, again = np.unique(which, return_inverse=True)
        return Traits(
            self.examples[kept], self.distinct_mean[kept], again.reshape(-1),
            self.features[rows], self.pairs.part(rows),
        )  # fmt: skip


class Settings(NamedTuple):
    """Variances beside the examples' own, in the log domain; chosen by evidence.

    Attributes
    ----------
    smooth, stretch
        Variance of the smooth deviation, and a factor on its length scales.
    exchange
        Variance of the breach of reciprocity.
    noise
        Variance of what no smooth function says, beside the samples' own sigma.
    """

    smooth: float
    stretch: float
    exchange: float
    noise: float


class Parts(NamedTuple):
    """Parts of a covariance: examples with exposure; smooth deviation and breach, of variance 1."""

    examples: Array
    smooth: Array
    exchange: Array

    def total(self, settings: Settings) -> Array:
        """Return their sum under some settings."""
        total = self.examples + settings.smooth * self.smooth
        # most materials keep reciprocity, and a product with zero takes its time as well
        return total + settings.exchange * self.exchange if settings.exchange else total


@dataclass(frozen=True)
class Family:
    """Isotropic materials, or any: a Gaussian process on ln(BRDF / white + 0.01).

    Its covariance is that of its examples, plus a smooth deviation, a breach of reciprocity and
    an unknown exposure.

    Attributes
    ----------
    name
        `isotropic` or `anisotropic`.
    examples
        Generated materials, which resemble what may come.
    learned
        Materials that were measured before. Ten of them count as much as all that were generated;
        fewer or more as n / (n + 10) of the whole.
    """

    name: str
    examples: GeneratedMaterials
    learned: tuple[LearnedMaterial, ...] = ()

    @property
    def isotropic(self) -> bool:
        """Whether it knows azimuths by their difference only."""
        return self.name == "isotropic"

    @cached_property
    def white(self) -> Array:
        """4 x each example's median over the 81 x 81 grid, told from every seventh pair, (n,)."""
        grid, _ = self.distinct(grid_pairs())
        some = np.arange(0, len(grid), max(1, len(grid) // 450))
        return np.asarray(4 * np.median(self._evaluate(grid.part(some)), axis=0))

    @property
    def weights(self) -> Array:
        """How much each example counts, the generated first; they add up to one."""
        generated, learned = len(self.examples), len(self.learned)
        share = learned / (learned + _AS_MANY)
        return np.concatenate(
            [np.full(generated, (1 - share) / generated), np.full(learned, share / max(learned, 1))]
        )

    def traits(self, pairs: Pairs) -> Traits:
        """Evaluate the examples at pairs; those equal by symmetry are evaluated once."""
        distinct, which = self.distinct(pairs)
        log = np.log(self._evaluate(distinct) / self.white + OFFSET)
        weights = self.weights
        mean = log @ weights
        log = (log - mean[:, None]) * np.sqrt(weights)
        features = isotropic_features if self.isotropic else anisotropic_features
        return Traits(log, mean, which, features(pairs), pairs)

    def covariances(self, a: Traits, b: Traits, stretch: float) -> Parts:
        """Return the covariances between pairs, part by part, shape (len(a), len(b)) each."""
        return Parts(
            self._of_examples(a, b),
            self._smooth(a, b, stretch),
            exchange(a.pairs, b.pairs, isotropic=self.isotropic),
        )

    def covariance(self, a: Traits, b: Traits, settings: Settings) -> Array:
        """Return the covariance between pairs, shape (len(a), len(b)), of what counts alone."""
        total = self._of_examples(a, b)
        smooth = self._smooth(a, b, settings.stretch)
        smooth *= settings.smooth
        total += smooth
        if settings.exchange:
            breach = exchange(a.pairs, b.pairs, isotropic=self.isotropic)
            breach *= settings.exchange
            total += breach
        return total

    def variances(self, traits: Traits) -> Parts:
        """Return the prior variance at each pair, part by part, shape (n,) each."""
        return Parts(
            (traits.examples**2).sum(1)[traits.which] + EXPOSURE,
            np.ones(len(traits.pairs)),
            exchange_variance(traits.pairs, isotropic=self.isotropic),
        )

    def expected(self, pairs: Pairs, settings: Settings) -> tuple[Array, Array]:
        """Return mean and variance of ln(BRDF + 0.01 white) in 1/sr at pairs, shape (n,) each.

        The scale is that of the examples' whites, taken as independent of the shape: among the
        examples those with strong highlights are dark, which real materials need not be.
        """
        traits, scale = self.traits(pairs), np.log(self.white)
        middle = scale @ self.weights
        spread = self.weights @ (scale - middle) ** 2
        variance = self.variances(traits).total(settings) - EXPOSURE + spread
        return traits.mean + middle, variance + settings.noise

    def _of_examples(self, a: Traits, b: Traits) -> Array:
        total = a.examples @ b.examples.T
        total += EXPOSURE
        return np.asarray(total[a.which][:, b.which])

    def _smooth(self, a: Traits, b: Traits, stretch: float) -> Array:
        scales = ISOTROPIC_SCALES if self.isotropic else ANISOTROPIC_SCALES
        return matern(a.features, b.features, scales * stretch)

    def _evaluate(self, pairs: Pairs) -> Array:
        learned = [each.evaluate(pairs)[:, None] for each in self.learned]
        return np.concatenate([self.examples.evaluate(pairs), *learned], axis=1)

    def distinct(self, pairs: Pairs) -> tuple[Pairs, NDArray[np.int64]]:
        """Return the pairs that differ in the family's eyes, and which of them each pair is."""
        return pairs.rotated() if self.isotropic else pairs.reciprocal()


def grid_pairs() -> Pairs:
    """Return all 6561 pairs of the 81 directions, light by light."""
    directions = paper_directions()
    count = len(directions)
    return Pairs.of(np.repeat(directions, count, axis=0), np.tile(directions, (count, 1)))


def pivoted_cholesky(diagonal: Array, column: Callable[[int], Array], rank: int) -> Array:
    """Return a factor of a covariance from few of its columns, shape (n, rank or fewer)."""
    return pivots_and_factor(diagonal, column, rank)[1]


def pivots_and_factor(
    diagonal: Array, column: Callable[[int], Array], rank: int
) -> tuple[NDArray[np.int64], Array]:
    """Return which columns of a covariance tell most, and the factor that they make.

    Harbrecht, Peters and Schneider (2012), algorithm 1: each step takes the column of the largest
    variance left.
    """
    left = diagonal.copy()
    factor = np.zeros((len(left), min(rank, len(left))))
    pivots = np.zeros(factor.shape[1], np.int64)
    for step in range(factor.shape[1]):
        pivots[step] = pivot = int(np.argmax(left))
        if left[pivot] <= _NOTHING * diagonal.max():
            return pivots[:step], factor[:, :step]
        rest = column(pivot) - factor[:, :step] @ factor[pivot, :step]
        factor[:, step] = rest / np.sqrt(left[pivot])
        left = (left - factor[:, step] ** 2).clip(0.0)
    return pivots, factor
