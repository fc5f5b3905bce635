"""Published reconstructions from few samples, for comparison."""

from nnbrdf.baselines.nbrdf import fit_nbrdf
from nnbrdf.baselines.pca_ridge import PcaRidge

__all__ = ["PcaRidge", "fit_nbrdf"]
