"""Priors made of another: one that remembers its answers, one of the isotropic kind alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from gonio.files import sha256_bytes

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from gonio.protocols import Prior, PriorKind

    Array = NDArray[np.float64]

ISOTROPIC = "isotropic"


class RememberedPrior:
    """A prior that is made when first asked, and factored once for all that ask of the same pairs.

    Its factors are pivoted: the first columns of a long one are those of a short one.

    Parameters
    ----------
    make
        Makes the prior.
    rank
        Columns to keep, where nobody asks for more.
    """

    def __init__(self, make: Callable[[], Prior], rank: int = 0) -> None:
        self._make, self._rank = make, rank
        self._prior: Prior | None = None
        self._told: dict[tuple[str, str], tuple[int, list[PriorKind]]] = {}

    def kinds(self, light: Array, view: Array, rank: int) -> list[PriorKind]:
        """Return the covariance of each kind at pairs (see `gonio.protocols.Prior`)."""
        key = sha256_bytes(light.tobytes()), sha256_bytes(view.tobytes())
        if key not in self._told or self._told[key][0] < rank:
            most = max(rank, self._rank)
            self._told[key] = most, self._known().kinds(light, view, most)
        return [_shortened(kind, rank) for kind in self._told[key][1]]

    def expected(self, light: Array, view: Array) -> tuple[Array, Array]:
        """Return mean and deviation of ln(BRDF) at pairs (see `gonio.protocols.Prior`)."""
        return self._known().expected(light, view)

    def _known(self) -> Prior:
        self._prior = self._prior or self._make()
        return self._prior


def _shortened(kind: PriorKind, rank: int) -> PriorKind:
    """Return a kind of fewer columns; what the others say goes to the rest."""
    dropped = np.einsum("ij,ij->i", kind.factor[:, rank:], kind.factor[:, rank:])
    rest = dropped if kind.rest is None else kind.rest + dropped
    return kind._replace(factor=np.ascontiguousarray(kind.factor[:, :rank]), rest=rest)


class IsotropicOnly:
    """What a prior says of isotropic materials, as if there were no others.

    Parameters
    ----------
    prior
        Whose kind `isotropic` counts.
    """

    def __init__(self, prior: Prior) -> None:
        self._prior = prior

    def kinds(self, light: Array, view: Array, rank: int) -> list[PriorKind]:
        """Return the isotropic kind alone, with the whole share.

        Raises
        ------
        BadInputError
            When the prior has no such kind.
        """
        kinds = self._prior.kinds(light, view, rank)
        kept = [kind._replace(share=1.0) for kind in kinds if kind.name == ISOTROPIC]
        if not kept:
            raise BadInputError("the prior has no isotropic kind; leave out --isotropic")
        return kept

    def expected(self, light: Array, view: Array) -> tuple[Array, Array]:
        """Return mean and deviation of ln(BRDF) at pairs, as any material of the prior has it."""
        return self._prior.expected(light, view)
