"""What turns samples into a material with sigma, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.errors import BadInputError
from nnbrdf.paper import PaperEstimator
from nnbrdf.teaching import TaughtEstimator

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.protocols import Estimator


def _prior(**settings: object) -> Estimator:
    from nnbrdf.posterior_model import PriorEstimator

    return PriorEstimator(**settings)  # type: ignore[arg-type]


def _analytic(**settings: object) -> Estimator:
    from nnbrdf.analytic_model import AnalyticEstimator

    return AnalyticEstimator(**settings)  # type: ignore[arg-type]


ESTIMATORS: dict[str, Callable[..., Estimator]] = {
    "nn": TaughtEstimator,
    "prior": _prior,
    "analytic": _analytic,
    "paper": PaperEstimator,
}
"""Factories by name, the default first; each takes the settings of its estimator as keywords."""


def estimator_named(name: str) -> Callable[..., Estimator]:
    """Return an estimator's factory.

    Raises
    ------
    BadInputError
        For an unknown name, listing the known.
    """
    if name not in ESTIMATORS:
        raise BadInputError(f"estimator {name!r} is not known; use {', '.join(ESTIMATORS)}")
    return ESTIMATORS[name]
