"""Priors for a scene's plan: one that remembers its answers, one of the isotropic kind alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.errors import BadInputError
from gonio.files import sha256_bytes

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.protocols import Prior, PriorKind
    from planner.scene.quantities import Array

ISOTROPIC = "isotropic"


class Remembered:
    """A prior that is made when first asked, and asked once for the same pairs.

    Parameters
    ----------
    make
        Makes it.
    """

    def __init__(self, make: Callable[[], Prior]) -> None:
        self._make = make
        self._prior: Prior | None = None
        self._told: dict[tuple[str, str, int], list[PriorKind]] = {}

    def kinds(self, light: Array, view: Array, rank: int) -> list[PriorKind]:
        """Return the covariance of each kind at pairs (see `gonio.protocols.Prior`)."""
        key = sha256_bytes(light.tobytes()), sha256_bytes(view.tobytes()), rank
        if key not in self._told:
            self._prior = self._prior or self._make()
            self._told[key] = self._prior.kinds(light, view, rank)
        return self._told[key]


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
