"""Criteria by which pairs of directions are chosen, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from gonio.protocols import Prior, Progress
    from planner.budget import Terms
    from planner.field import Field


class Choice(NamedTuple):
    """What was chosen.

    Attributes
    ----------
    measured
        Which pairs, shape (L, V), indexed [light, view]; of a product all, those not allowed, too.
    variance_left
        Share of the prior's variance that they leave, where the criterion knows a prior.
    variance_bound
        What any choice of as many pairs leaves at least, where it is known.
    """

    measured: NDArray[np.bool_]
    variance_left: float | None = None
    variance_bound: float | None = None


class Criterion(Protocol):
    """Chooses what to measure among the pairs of a field."""

    def product(self, field: Field, lights: int, views: int) -> Choice:
        """Choose `lights` and `views` directions; every allowed pair of them is measured.

        There are at least as many that take part in an allowed pair.
        """

    def pairs(self, field: Field, count: int) -> Choice:
        """Choose `count` of the allowed pairs, of which there are at least as many."""

    def within(self, field: Field, seconds: float, terms: Terms) -> Choice:
        """Choose allowed pairs that can be captured in a time.

        Raises
        ------
        BadInputError
            When the time is too short, or the criterion cannot tell what a pair is worth.
        """


CRITERIA = ("i-optimal", "d-optimal", "energy", "farthest", "random")
PRIOR_CRITERIA = ("i-optimal", "d-optimal")
"""Those that want a prior."""


def criterion_named(
    name: str,
    prior: Callable[[], Prior] | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Criterion:
    """Return a criterion.

    Parameters
    ----------
    name
        One of `CRITERIA`.
    prior
        Makes the prior, for those of `PRIOR_CRITERIA`.
    seed
        Of the random choice.
    progress
        Called by `PRIOR_CRITERIA` with the steps of the search done, and those there may be.

    Raises
    ------
    BadInputError
        For an unknown name, listing the known, and for one of `PRIOR_CRITERIA` without a prior.
    """
    from planner.optimal import DOptimal, IOptimal
    from planner.spread import FarthestPoint, LeastEnergy, RandomChoice

    if name not in CRITERIA:
        raise BadInputError(f"criterion {name!r} is not known; use {', '.join(CRITERIA)}")
    if name == "farthest":
        return FarthestPoint()
    if name == "energy":
        return LeastEnergy()
    if name == "random":
        return RandomChoice(seed)
    if prior is None:
        raise BadInputError(f"criterion {name} needs a prior; use farthest, or pass one")
    return (IOptimal if name == "i-optimal" else DOptimal)(prior, progress)
