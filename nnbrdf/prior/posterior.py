"""What is believed of a material once samples of it are known."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nnbrdf.cores import threads_for
from nnbrdf.prior.family import Family, Parts, Settings, Traits

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from nnbrdf.prior.geometry import Pairs

    Array = NDArray[np.float64]

SMOOTH = (0.0003, 0.003, 0.03, 0.3)
STRETCH = (0.7, 1.5)
EXCHANGE = (0.0, 0.003, 0.03, 0.2)
NOISE = (1e-5, 1e-4, 1e-3, 1e-2, 6e-2)
_JUDGES = 400
_COUNTS = 0.02
_KEPT = 4
_CLEAR = 3.0
_CERTAIN = 1e6
_CHUNK = 10_000_000


@dataclass(frozen=True)
class Component:
    """A Gaussian process under one family and one choice of settings.

    Attributes
    ----------
    family, settings
        Whose covariance it has.
    traits
        Of the samples' pairs.
    cholesky
        Lower factor of the samples' covariance with noise, shape (n, n).
    weights
        The covariance's inverse times the samples less their prior mean, shape (n, channels).
    jitter
        What was added to the diagonal to factor it.
    """

    family: Family
    settings: Settings
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

        covariance = self.family.covariance(self.traits, traits, self.settings)
        prior = self.family.variances(traits).total(self.settings)
        mean = traits.mean[:, None] + covariance.T @ self.weights
        known = solve_triangular(
            self.cholesky, covariance, lower=True, overwrite_b=True, check_finite=False
        )
        left = prior - np.einsum("ij,ij->j", known, known)
        return mean, left.clip(0.0) + self.settings.noise

    def leave_one_out(self) -> tuple[Array, Array]:
        """Return the residual of each sample against all others, (n, channels), and its variance.

        Rasmussen and Williams (2006), equations 5.10 to 5.12; the variance has the noise in it.
        """
        from scipy.linalg.lapack import dtrtri

        inverse, _ = dtrtri(self.cholesky, lower=1)
        precision = np.einsum("ij,ij->j", inverse, inverse)
        return self.weights / precision[:, None], 1 / precision


class Odds(NamedTuple):
    """Logarithms of odds: of being isotropic, and of being reciprocal, over not being so."""

    isotropic: float
    reciprocal: float


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
        What the samples say of symmetries.
    """

    components: tuple[Component, ...]
    shares: Array
    odds: Odds

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
        """Whether the samples leave it open that light and view may be exchanged."""
        return self.odds.reciprocal > -_CLEAR

    def predict(self, pairs: Pairs) -> tuple[Array, Array]:
        """Return mean, shape (n, channels), and standard deviation, alike, of the logarithm."""
        samples = len(self.best.cholesky)
        chunk = max(_CHUNK // samples, 1)
        with threads_for(samples):
            parts = [
                self._predict(pairs.part(slice(start, start + chunk)))
                for start in range(0, len(pairs), chunk)
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
        self._last: tuple[object, Array] | None = None

    @cached_property
    def _parts(self) -> list[tuple[Family, Array, float, Parts]]:
        result = []
        for family, traits in self._traits:
            judges = traits.part(self._judges)
            for stretch in STRETCH:
                parts = family.covariances(judges, judges, stretch)
                result.append((family, judges.mean, stretch, parts))
        return result

    def condition(self, log: Array, noise: Array, *, thorough: bool = True) -> Posterior:
        """Choose families and settings by evidence and condition them on samples.

        Parameters
        ----------
        log
            ln(value / scale + 0.01), shape (n, channels).
        noise
            Their variance by the samples' own sigma, shape (n,).
        thorough
            Else only every other value of breach and noise is tried, in a quarter of the time.
        """
        step = 1 if thorough else 2
        with threads_for(len(self._judges)):
            judged = self._judge(log[self._judges], noise[self._judges], step)
        best = judged[0][0]
        limit = 1 if self._many else _KEPT
        kept = [each for each in judged[:limit] if np.exp(each[0] - best) > _COUNTS]
        shares = np.exp(np.array([each[0] for each in kept]) - best)
        chosen = [(family.name, settings) for _, family, settings in kept]
        return self.under(chosen, shares / shares.sum(), _odds(judged), log, noise)

    def under(
        self,
        chosen: Sequence[tuple[str, Settings]],
        shares: Array,
        odds: Odds,
        log: Array,
        noise: Array,
    ) -> Posterior:
        """Condition on samples under families, by name, and settings that were chosen before.

        `shares` and `odds` as in `Posterior`, `log` and `noise` as in `condition`.
        """
        components = tuple(self._component(*each, log, noise) for each in chosen)
        return Posterior(components, shares, odds)

    def _judge(self, log: Array, noise: Array, step: int) -> list[tuple[float, Family, Settings]]:
        """Return the evidence of the settings, the likeliest first."""
        result = []
        for family, mean, stretch, parts in self._parts:
            for smooth, breach, own in product(SMOOTH, EXCHANGE[::step], NOISE[::step]):
                settings = Settings(smooth, stretch, breach, own)
                lower, _ = _cholesky(parts.total(settings), own + noise)
                result.append((_log_probability(lower, log - mean[:, None]), family, settings))
        return sorted(result, key=lambda each: -each[0])

    def _component(self, name: str, settings: Settings, log: Array, noise: Array) -> Component:
        from scipy.linalg import cho_solve

        family, traits = next(each for each in self._traits if each[0].name == name)
        covariance = self._covariance(family, traits, settings)
        lower, jitter = _cholesky(covariance, settings.noise + noise)
        weights = cho_solve((lower, True), log - traits.mean[:, None], check_finite=False)
        return Component(family, settings, traits, lower, weights, jitter)

    def _covariance(self, family: Family, traits: Traits, settings: Settings) -> Array:
        """Return the covariance of all samples; of many, the last is kept for the next round."""
        key = family.name, settings._replace(noise=0.0)
        if self._last is None or self._last[0] != key:
            self._last = key, family.covariance(traits, traits, settings)
        return self._last[1]


def _odds(judged: list[tuple[float, Family, Settings]]) -> Odds:
    evidence = np.array([each[0] for each in judged])
    isotropic = np.array([family.isotropic for _, family, _ in judged])
    # among the settings of the likelier kind only: the other's breach says nothing
    likelier = isotropic == isotropic[0]
    reciprocal = np.array([settings.exchange == 0 for *_, settings in judged])
    return Odds(_log_odds(evidence, isotropic), _log_odds(evidence[likelier], reciprocal[likelier]))


def _log_odds(evidence: Array, true: NDArray[np.bool_]) -> float:
    """Return the logarithm of the odds that the settings where `true` are meant."""

    def total(rows: NDArray[np.bool_]) -> float:
        # the mean, not the sum: there are more settings of one kind than of the other
        some = np.logaddexp.reduce(evidence[rows]) - np.log(rows.sum()) if rows.any() else -np.inf
        return float(np.maximum(some, -_CERTAIN))

    return total(true) - total(~true)


def _log_probability(lower: Array, residual: Array) -> float:
    from scipy.linalg import solve_triangular

    white = solve_triangular(lower, residual, lower=True, check_finite=False)
    spread = np.log(np.diag(lower)).sum() + 0.5 * len(lower) * np.log(2 * np.pi)
    return float(_channels(residual) * (-0.5 * (white**2).mean(axis=1).sum() - spread))


def _channels(residual: Array) -> float:
    """Return how many channels there are in effect: 1 if all are alike, their number if none is.

    The participation ratio of the eigenvalues of their second moments.
    """
    moments = residual.T @ residual
    square = float((moments**2).sum())
    return float(np.trace(moments)) ** 2 / square if square > 0 else 1.0


def _cholesky(covariance: Array, noise: Array) -> tuple[Array, float]:
    """Return the lower factor of a covariance with noise, and the jitter that it took."""
    from scipy.linalg import LinAlgError, cholesky

    jitter = 0.0
    while True:
        try:
            total = covariance.copy(order="F")
            total.flat[:: len(total) + 1] += noise + jitter
            return cholesky(total, lower=True, overwrite_a=True, check_finite=False), jitter
        except LinAlgError:
            jitter = max(10 * jitter, 1e-10 * float(np.trace(covariance)) / len(covariance))
