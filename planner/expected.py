"""How wrong a material will be that is told from some pairs, as far as a prior knows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from planner.information import Unknown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.protocols import Prior, PriorKind
    from planner.field import Field

RANK = 400
"""Columns of the factor that errors are told with: with fewer, many shots would look too good."""
FEWER_RANK, _MANY_PAIRS = 150, 40_000
_TINY = float(np.finfo(float).tiny)


class ExpectedError:
    """The posterior standard deviation of ln(BRDF), root mean square over all pairs.

    Kinds of material count by their shares.

    Parameters
    ----------
    field
        The pairs, and how much each counts.
    prior
        What is believed of the material.
    """

    def __init__(self, field: Field, prior: Prior) -> None:
        demand = None if field.demand is None else field.demand.ravel()
        self._ask(prior.kinds(*field.pairs, rank_for(field)), demand, field.allowed.size)

    @classmethod
    def at(
        cls, light: NDArray[np.float64], view: NDArray[np.float64], demand: NDArray[np.float64],
        prior: Prior,
    ) -> ExpectedError:  # fmt: skip
        """Make it of any pairs, unit vectors of shape (n, 3) each, that count by `demand`, (n,)."""
        made = cls.__new__(cls)
        made._ask(prior.kinds(light, view, RANK), demand, len(demand))
        return made

    def _ask(
        self, kinds: Sequence[PriorKind], demand: NDArray[np.float64] | None, pairs: int
    ) -> None:
        self._unknown = [Unknown(kind, demand) for kind in kinds]
        # where nothing counts there is no error
        total = max(float(pairs if demand is None else demand.sum()), _TINY)
        self._variance = [each.whole / total for each in self._unknown]

    def after(self, measured: NDArray[np.int64]) -> float:
        """Return what is to be expected once `measured` are, indices of pairs, shape (n,)."""
        for each in self._unknown:
            each.forget(measured)
        left = (
            each.remaining * whole
            for each, whole in zip(self._unknown, self._variance, strict=True)
        )
        return float(np.sqrt(max(sum(left), 0.0)))


def rank_for(field: Field) -> int:
    """Return how many columns of the factor fit into memory at the pairs of a field."""
    return RANK if field.allowed.size <= _MANY_PAIRS else FEWER_RANK
