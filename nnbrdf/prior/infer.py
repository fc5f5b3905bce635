"""From samples to the posterior: scale, noise, clipped highlights, gross outliers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.samples import WHITE_PER_MEDIAN, Flag
from nnbrdf.cores import threads_for
from nnbrdf.prior.family import grid_pairs
from nnbrdf.prior.geometry import Pairs
from nnbrdf.prior.log import OFFSET
from nnbrdf.prior.lognormal import LogNormal
from nnbrdf.prior.posterior import Posterior, Sites

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.samples import Samples
    from nnbrdf.prior.family import Family

    Array = NDArray[np.float64]

_IGNORED = 1e4
_FAR = 4.0
_LEAST = 1e-8
_ROUNDS = 4
_SPREAD = (0.8, 2.0)
_Z90 = 1.6448536269514722


@dataclass(frozen=True)
class Inference:
    """What samples make of the prior.

    Attributes
    ----------
    posterior
        Of ln(value / scale + 0.01).
    scale
        4 x the median of the material over the 81 x 81 grid, as far as it is known, in 1/sr.
    inflation
        Factor on the posterior's deviations, told from each sample left out in turn.
    outliers
        Which samples the others do not explain, so that they count less, shape (n,).
    bounds
        Which samples are clipped and lie below what the others say: lower bounds, left out.
    log, noise
        What the posterior was conditioned on, shapes (n, channels) and (n,).
    """

    posterior: Posterior
    scale: float
    inflation: float
    outliers: NDArray[np.bool_]
    bounds: NDArray[np.bool_]
    log: Array
    noise: Array

    def predict(self, light: Array, view: Array) -> LogNormal:
        """Return the posterior at unit vectors of shape (n, 3)."""
        mean, deviation = self.posterior.predict(Pairs.of(light, view))
        return LogNormal(mean, self.inflation * deviation, self.scale)


def infer(families: Sequence[Family], samples: Samples) -> Inference:
    """Condition the families of a prior on samples.

    Values below zero count as zero. Clipped values that lie below what the others say are lower
    bounds and tell nothing more. A sample that lies four deviations or more from what the others
    say of it is given its residual as noise: it may be a gross error or a peak that no other sample
    announces, and in either case says little of its neighbors.
    """
    with threads_for(len(samples)):
        return _infer(Sites(families, Pairs.of(samples.light, samples.view)), samples)


def _infer(sites: Sites, samples: Samples) -> Inference:
    scale = samples.white
    clipped = np.asarray((samples.flag & Flag.CLIPPED).astype(bool).any(axis=1))
    doubt = np.zeros(len(samples))
    # clipped neighbors would vouch for each other: each is let in only where the others stay below
    bounds = clipped.copy()
    for remaining in reversed(range(_ROUNDS)):
        log = np.log(samples.value.clip(0.0) / scale + OFFSET)
        noise = np.where(bounds, _IGNORED, _noise(samples, scale) + doubt)
        posterior = sites.condition(log, noise, thorough=not remaining)
        if remaining:
            residual, variance = posterior.best.leave_one_out()
            squared = (residual**2).mean(axis=1)
            bounds = np.asarray(clipped & (residual.mean(axis=1) < 0))
            far = squared > _FAR**2 * (variance - doubt).clip(_LEAST)
            doubt = np.where(far & ~clipped, squared, 0.0)
            scale = _scale(posterior, scale)
    return Inference(posterior, scale, _inflation(posterior, bounds), doubt > 0, bounds, log, noise)


def _noise(samples: Samples, scale: float) -> Array:
    """Return the variance of the logarithm by the samples' own sigma, shape (n,); 0 if unknown."""
    relative = samples.sigma / (samples.value.clip(0.0) + OFFSET * scale)
    variance = np.nan_to_num(relative, nan=0.0).clip(max=10.0) ** 2
    return np.asarray(variance.mean(axis=1))


def _scale(posterior: Posterior, scale: float) -> float:
    """Return 4 x the median told of the grid, from every twentieth of its pairs."""
    mean, _ = posterior.predict(grid_pairs().part(slice(None, None, 20)))
    return WHITE_PER_MEDIAN * scale * float((np.exp(np.median(mean)) - OFFSET).clip(OFFSET / 10))


def _inflation(posterior: Posterior, ignored: NDArray[np.bool_]) -> float:
    """Return by how much residuals of samples left out in turn pass what was expected of them."""
    residual, variance = posterior.best.leave_one_out()
    scores = np.abs(residual / np.sqrt(variance)[:, None])[~ignored]
    return float(np.clip(np.quantile(scores, 0.9) / _Z90, *_SPREAD))
