"""A smooth model of the samples at hand, for its slopes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.errors import BadInputError
from gonio.materials import Lambertian

if TYPE_CHECKING:
    from gonio.protocols import Material
    from gonio.samples import Samples

_MODEL = "ggx"
# slopes need not be those of the best of all fits
_STARTS = 2


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
