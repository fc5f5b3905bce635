"""What materials look like before they are measured, and what samples make of that."""

from nnbrdf.prior.family import Family
from nnbrdf.prior.geometry import Pairs
from nnbrdf.prior.material_prior import MaterialPrior
from nnbrdf.prior.posterior import Posterior, Sites

__all__ = ["Family", "MaterialPrior", "Pairs", "Posterior", "Sites"]
