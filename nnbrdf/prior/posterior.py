"""What is believed of a material once samples of it are known."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.prior.family import Family, Parts, Settings, Traits

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from nnbrdf.prior.geometry import Pairs

    Array = NDArray[np.float64]

SMOOTH = (0.003, 0.03, 0.3)
STRETCH = (0.7, 1.5)
EXCHANGE = (0.0, 0.003, 0.03, 0.2)
NOISE = (1e-4, 1e-3, 1e-2, 6e-2)
_JUDGES = 400
_COUNTS = 0.02
_KEPT = 4
_CHUNK = 1 << 11


@dataclass(frozen=True)
class Component:
    """A Gaussian process under one family and one choice of settings.

    Attributes
    ----------
    family, settings
        Whose covariance it has.
    evidence
        Logarithm of the probability of the observations under it.
    """

    family: Family
    settings: Settings
    evidence: float
    traits: Traits
    cholesky: Array
    weights: Array
    jitter: float

    @property
    def condition(self) -> float:
        """Condition number of the samples' covariance, told from its factor's diagonal.

        The square of the largest entry over the smallest: no more than the condition number.
        """
        diagonal = np.diag(self.cholesky)
        return float((diagonal.max() / diagonal.min()) ** 2)

    def predict(self, traits: Traits) -> tuple[Array, Array]:
        """Return mean, shape (n, channels), and variance, shape (n,), of the logarithm.

        The noise of the settings is in it: what no smooth function says of the samples it does not
        say of the other pairs either.
        """
        from scipy.linalg import solve_triangular

        cross = self.family.covariances(traits, self.traits, self.settings.stretch)
        covariance = cross.total(self.settings)
        known = solve_triangular(self.cholesky, covariance.T, lower=True, check_finite=False)
        prior = self.family.variances(traits).total(self.settings)
        mean = traits.mean[:, None] + covariance @ self.weights
        return mean, (prior - (known**2).sum(0)).clip(0.0) + self.settings.noise

    def leave_one_out(self, log: Array) -> tuple[Array, Array]:
        """Return the residual of each sample against all others, (n, channels), and its variance.

        Rasmussen and Williams (2006), equations 5.10 to 5.12; the variance has the noise in it.
        """
        from scipy.linalg import solve_triangular

        inverse = solve_triangular(self.cholesky, np.eye(len(log)), lower=True, check_finite=False)
        precision = (inverse**2).sum(0)
        return self.weights / precision[:, None], 1 / precision


@dataclass(frozen=True)
class Posterior:
    """A mixture of Gaussian processes, weighted by evidence.

    Attributes
    ----------
    components
        The likeliest first.
    shares
        Their probabilities, shape (components,).
    odds
        Logarithm of the probability of being isotropic over that of not being so.
    """

    components: tuple[Component, ...]
    shares: Array
    odds: float

    @property
    def best(self) -> Component:
        """The likeliest component."""
        return self.components[0]

    @property
    def isotropic(self) -> bool:
        """Whether the samples speak for a material that knows azimuths by their difference only."""
        return self.best.family.isotropic

    @property
    def reciprocal(self) -> bool:
        """Whether the samples allow that light and view be exchanged."""
        return self.best.settings.exchange == 0

    def predict(self, pairs: Pairs) -> tuple[Array, Array]:
        """Return mean, shape (n, channels), and standard deviation, alike, of the logarithm."""
        parts = [
            self._predict(pairs.part(slice(start, start + _CHUNK)))
            for start in range(0, len(pairs), _CHUNK)
        ]
        mean, deviation = zip(*parts, strict=True)
        return np.concatenate(mean), np.concatenate(deviation)

    def _predict(self, pairs: Pairs) -> tuple[Array, Array]:
        traits = {
            family.name: family.traits(pairs)
            for family in {c.family.name: c.family for c in self.components}.values()
        }
        mean: Array | float = 0.0
        square: Array | float = 0.0
        for share, component in zip(self.shares, self.components, strict=True):
            here, variance = component.predict(traits[component.family.name])
            mean = mean + share * here
            square = square + share * (variance[:, None] + here**2)
        return np.asarray(mean), np.sqrt((np.asarray(square) - np.asarray(mean) ** 2).clip(0.0))


class Sites:
    """Pairs at which samples were taken, with all that families say of them.

    Settings are judged at no more than 400 of the pairs, evenly spread.

    Parameters
    ----------
    families
        What the material may be.
    pairs
        Where the samples were taken, n of them.
    """

    def __init__(self, families: Sequence[Family], pairs: Pairs) -> None:
        self._traits = [(family, family.traits(pairs)) for family in families]
        count = len(pairs)
        self._judges = np.unique(np.linspace(0, count - 1, _JUDGES).round().astype(np.int64))
        self._many = count > _JUDGES

    @cached_property
    def _parts(self) -> list[tuple[Family, Array, float, Parts]]:
        result = []
        for family, traits in self._traits:
            judges = traits.part(self._judges)
            for stretch in STRETCH:
                parts = family.covariances(judges, judges, stretch)
                result.append((family, judges.mean, stretch, parts))
        return result

    def condition(self, log: Array, noise: Array) -> Posterior:
        """Choose families and settings by evidence and condition them on samples.

        Parameters
        ----------
        log
            ln(value / scale + 0.01), shape (n, channels).
        noise
            Their variance by the samples' own sigma, shape (n,).
        """
        judged = self._judge(log[self._judges], noise[self._judges])
        best = judged[0][0]
        limit = 1 if self._many else _KEPT
        kept = [each for each in judged[:limit] if np.exp(each[0] - best) > _COUNTS]
        components = tuple(self._component(*each, log, noise) for each in kept)
        shares = np.exp(np.array([each[0] for each in kept]) - best)
        return Posterior(components, shares / shares.sum(), _odds(judged))

    def _judge(self, log: Array, noise: Array) -> list[tuple[float, Family, Settings]]:
        """Return the evidence of all settings, the likeliest first."""
        result = []
        for family, mean, stretch, parts in self._parts:
            for smooth, breach, own in product(SMOOTH, EXCHANGE, NOISE):
                settings = Settings(smooth, stretch, breach, own)
                lower, _ = _cholesky(parts.total(settings), own + noise)
                result.append((_log_probability(lower, log - mean[:, None]), family, settings))
        return sorted(result, key=lambda each: -each[0])

    def _component(
        self, evidence: float, family: Family, settings: Settings, log: Array, noise: Array
    ) -> Component:
        from scipy.linalg import cho_solve

        traits = next(traits for each, traits in self._traits if each is family)
        covariance = family.covariances(traits, traits, settings.stretch).total(settings)
        lower, jitter = _cholesky(covariance, settings.noise + noise)
        weights = cho_solve((lower, True), log - traits.mean[:, None], check_finite=False)
        return Component(family, settings, evidence, traits, lower, weights, jitter)


def _odds(judged: list[tuple[float, Family, Settings]]) -> float:
    """Return the logarithm of the odds of being isotropic."""
    by_kind: dict[bool, list[float]] = {True: [-np.inf], False: [-np.inf]}
    for evidence, family, _ in judged:
        by_kind[family.isotropic].append(evidence)
    return float(np.logaddexp.reduce(by_kind[True]) - np.logaddexp.reduce(by_kind[False]))


def _log_probability(lower: Array, residual: Array) -> float:
    from scipy.linalg import solve_triangular

    white = solve_triangular(lower, residual, lower=True, check_finite=False)
    spread = np.log(np.diag(lower)).sum() + 0.5 * len(lower) * np.log(2 * np.pi)
    return float(-0.5 * (white**2).sum() - residual.shape[1] * spread)


def _cholesky(covariance: Array, noise: Array) -> tuple[Array, float]:
    """Return the lower factor of a covariance with noise, and the jitter that it took."""
    from scipy.linalg import LinAlgError, cholesky

    jitter = 0.0
    while True:
        try:
            total = covariance + np.diag(noise + jitter)
            return np.asarray(cholesky(total, lower=True, check_finite=False)), jitter
        except LinAlgError:
            jitter = max(10 * jitter, 1e-10 * float(np.trace(covariance)) / len(covariance))
