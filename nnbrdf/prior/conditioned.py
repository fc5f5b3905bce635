"""The prior once samples are known, and others are on their way: for choosing what comes next."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.protocols import PriorKind
from nnbrdf.prior.family import grid_pairs, pivoted_cholesky
from nnbrdf.prior.geometry import Pairs
from nnbrdf.prior.ground import Grounds
from nnbrdf.prior.material_prior import EXPECTED, KIND_SHARES, SOME_EXAMPLES, thinned

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from nnbrdf.prior.family import Family, Settings
    from nnbrdf.prior.ground import Ground
    from nnbrdf.prior.infer import Inference
    from nnbrdf.prior.lognormal import LogNormal

    Array = NDArray[np.float64]

DOUBT = 0.5
"""How much what was believed before still counts for a choice, whatever the samples say.

Few samples are told easily by settings that are wrong, and pairs chosen under these alone would not
show it: an isotropic material, say, is measured at one azimuth.
"""
_COUNTS = 0.1
_JITTER = 1e-9


class Belief(NamedTuple):
    """A family, with few of its examples, under some settings, and how much that counts."""

    family: Family
    settings: Settings
    share: float


class _Part(NamedTuple):
    """What one belief has left: of the pairs that differ, and which of these each pair is."""

    factor: Array
    which: NDArray[np.int64]
    variance: Array

    @property
    def rest(self) -> Array:
        """The variance that the factor leaves out, shape (distinct,)."""
        return np.asarray((self.variance - (self.factor**2).sum(axis=1)).clip(min=0.0))


@dataclass(frozen=True)
class ConditionedPrior:
    """What is still unknown of a material, as `gonio.protocols.Prior`.

    Of a Gaussian process, what samples leave unknown hangs on where they were taken and on its
    settings, not on their values; so samples to come are conditioned on, too.

    Attributes
    ----------
    inference
        What the samples tell.
    told
        What they leave possible: the posterior's components. Their shares add up to one.
    before
        What was held possible before, likewise.
    sites
        Where samples were taken and will be.
    noise
        Variance of each in the log domain by its own sigma, shape (sites,).
    grounds
        Keeps what families say of the candidates, from one prior to the next.
    """

    inference: Inference
    told: tuple[Belief, ...]
    before: tuple[Belief, ...]
    sites: Pairs
    noise: Array
    grounds: Grounds = field(default_factory=Grounds)

    @classmethod
    def of(
        cls,
        families: Sequence[Family],
        inference: Inference,
        sites: Pairs,
        grounds: Grounds | None = None,
    ) -> ConditionedPrior:
        """Make it of what samples told.

        Parameters
        ----------
        families
            Of the prior that they were told under.
        inference
            What they told.
        sites
            Where they were taken, in their order, then where others are on their way.
        grounds
            Of the last such prior, to go on with.
        """
        few = {family.name: thinned(family, SOME_EXAMPLES) for family in families}
        return cls(
            inference,
            _told(few, inference),
            tuple(Belief(few[name], EXPECTED, share) for name, share in KIND_SHARES.items()),
            sites,
            _with_coming(inference.noise, len(sites)),
            grounds or Grounds(),
        )

    @cached_property
    def now(self) -> LogNormal:
        """What the samples tell of the 81 x 81 pairs, shape (6561, channels)."""
        grid = grid_pairs()
        return self.inference.predict(grid.light, grid.view)

    @property
    def deviation(self) -> float:
        """Mean posterior standard deviation of ln(f + 0.01 white) over the 81 x 81 pairs."""
        return float(self.now.deviation.mean())

    def deviation_after(self, light: Array, view: Array) -> float:
        """Return what `deviation` is expected to become by those to come and further samples.

        Parameters
        ----------
        light, view
            Where they will be taken, unit vectors, shape (n, 3).
        """
        taken = slice(len(self.inference.noise))
        fewer = replace(self, sites=self.sites.part(taken), noise=self.inference.noise)
        ends = (self.sites.light, light), (self.sites.view, view)
        sites = Pairs.of(*(np.concatenate(end) for end in ends))
        more = replace(self, sites=sites, noise=_with_coming(self.noise, len(sites)))
        shrunk = np.sqrt(more._left() / fewer._left())
        return float((self.now.deviation * shrunk[:, None]).mean())

    def expected(self, light: Array, view: Array) -> tuple[Array, Array]:
        """Return mean and deviation of the logarithm at pairs (see `gonio.protocols.Prior`).

        Of a material of several colors they are over its channels, too.
        """
        told = self.inference.predict(light, view)
        variance = (told.deviation**2).mean(axis=1) + told.mean.var(axis=1)
        return told.mean.mean(axis=1) + np.log(told.scale), np.sqrt(variance)

    def kinds(self, light: Array, view: Array, rank: int) -> list[PriorKind]:
        """Return the covariance that each belief has left (see `gonio.protocols.Prior`).

        Of what the samples tell, shares count the variance left, as it is; of what was believed
        before, the share of its variance that is left, as where nothing is known yet.
        """
        kinds = []
        for beliefs, weight in ((self.told, 1 - DOUBT), (self.before, DOUBT)):
            parts = [self._part(belief, light, view, rank) for belief in beliefs]
            left = [
                belief.share * float(part.variance[part.which].mean())
                for belief, part in zip(beliefs, parts, strict=True)
            ]
            if beliefs is self.before:
                whole = [self._whole(belief, light, view) for belief in beliefs]
                left = [part / all_of_it for part, all_of_it in zip(left, whole, strict=True)]
            kinds += [
                PriorKind(
                    belief.family.name,
                    weight * share / sum(left),
                    part.factor,
                    part.which,
                    part.rest,
                )
                for belief, share, part in zip(beliefs, left, parts, strict=True)
            ]
        return kinds

    def _whole(self, belief: Belief, light: Array, view: Array) -> float:
        """Return the mean variance of pairs before anything was measured."""
        ground = self._ground(belief, light, view)
        variance = belief.family.variances(ground.traits).total(belief.settings)
        return float(variance[ground.which].mean())

    def _part(self, belief: Belief, light: Array, view: Array, rank: int) -> _Part:
        """Return a factor of cov(., i) - K(., s) K_ss^-1 K(s, i), and what it leaves out."""
        family, settings, _ = belief
        ground = self._ground(belief, light, view)
        known = self._known(belief, ground)

        def column(index: int) -> Array:
            one = ground.traits.part(np.array([index]))
            prior = family.covariance(ground.traits, one, settings)[:, 0]
            return np.asarray(prior - known.T @ known[:, index])

        variance = _variance(belief, ground, known)
        factor = pivoted_cholesky(variance, column, rank)
        return _Part(factor, ground.which, variance)

    def _left(self) -> Array:
        """Return the variance left at the 81 x 81 pairs, noise included, shape (6561,)."""
        grid = grid_pairs()
        left = np.zeros(len(grid))
        for belief in self.told:
            ground = self._ground(belief, grid.light, grid.view)
            variance = _variance(belief, ground, self._known(belief, ground))
            left += belief.share * (variance[ground.which] + belief.settings.noise)
        return left

    def _ground(self, belief: Belief, light: Array, view: Array) -> Ground:
        both_ways = bool(belief.settings.exchange)
        return self.grounds.of(belief.family, light, view, both_ways=both_ways)

    def _known(self, belief: Belief, ground: Ground) -> Array:
        """Return L^-1 K(s, .) with the sites' covariance L L^T, shape (sites, distinct)."""
        from scipy.linalg import cholesky, solve_triangular

        family, settings, _ = belief
        sites = family.traits(self.sites)
        covariance = family.covariance(sites, sites, settings)
        covariance.flat[:: len(covariance) + 1] += settings.noise + self.noise + _JITTER
        lower = cholesky(covariance, lower=True, overwrite_a=True, check_finite=False)
        across = family.covariance(sites, ground.traits, settings)
        return np.asarray(
            solve_triangular(lower, across, lower=True, overwrite_b=True, check_finite=False)
        )


def _variance(belief: Belief, ground: Ground, known: Array) -> Array:
    prior = belief.family.variances(ground.traits).total(belief.settings)
    return np.asarray((prior - np.einsum("ij,ij->j", known, known)).clip(0.0))


def _with_coming(noise: Array, count: int) -> Array:
    """Give samples that are on their way the noise that is usual."""
    return np.concatenate([noise, np.full(count - len(noise), np.median(noise))])


def _told(few: dict[str, Family], inference: Inference) -> tuple[Belief, ...]:
    """Return the components that count; those that differ by their noise alone as one."""
    posterior = inference.posterior
    merged: dict[tuple[str, Settings], Belief] = {}
    for component, share in zip(posterior.components, posterior.shares.tolist(), strict=True):
        name, settings = component.family.name, component.settings
        key = name, settings._replace(noise=0.0)
        before = merged.get(key, Belief(few[name], settings, 0.0))
        merged[key] = before._replace(share=before.share + share)
    kept = [belief for belief in merged.values() if belief.share >= _COUNTS]
    total = sum(belief.share for belief in kept)
    return tuple(belief._replace(share=belief.share / total) for belief in kept)
