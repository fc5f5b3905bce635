"""A smooth model of the samples at hand, for its slopes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from gonio.materials import Lambertian

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Material
    from gonio.samples import Samples

_MODEL = "ggx"
# slopes need not be those of the best of all fits
_STARTS = 2
# beyond, a value is black or a highlight that no scatter describes
_FARTHEST = 1.5
_BLACK = 1e-9


def smooth_fit(samples: Samples) -> Material:
    """Return a GGX lobe over a diffuse body, fitted to the samples.

    Its slopes are those of ln f, so that its level does not matter. Too few samples, or black ones,
    tell of no slope: they get a diffuse one's, which is none.
    """
    from nnbrdf.fitting.fit import fit_model

    try:
        return fit_model(_MODEL, samples, starts=_STARTS).material
    except BadInputError:
        return Lambertian(1.0)


def misfit(samples: Samples, fit: Material) -> NDArray[np.float64]:
    """Return the scatter of ln f about a fit to the samples, shape (3,): lobes that it misses."""
    logs = np.log(
        samples.value.clip(_BLACK) / fit.evaluate(samples.light, samples.view).clip(_BLACK)
    )
    away = logs - np.median(logs, axis=0)
    return np.asarray(np.sqrt(np.mean(np.clip(away, -_FARTHEST, _FARTHEST) ** 2, axis=0)))
