"""Reflectance models of the literature, fitted to samples."""

from nnbrdf.fitting.fit import Fit, fit_model
from nnbrdf.fitting.models import MODELS, model_named

__all__ = ["MODELS", "Fit", "fit_model", "model_named"]
