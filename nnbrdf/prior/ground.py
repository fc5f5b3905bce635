"""What families say of candidate pairs, evaluated once and kept while samples come in."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nnbrdf.prior.geometry import Pairs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nnbrdf.prior.family import Family, Traits

    Array = NDArray[np.float64]


class Ground(NamedTuple):
    """Candidate pairs in the eyes of a family.

    Attributes
    ----------
    traits
        Of the pairs that differ.
    which
        Which of these each pair is, shape (n,).
    """

    traits: Traits
    which: NDArray[np.int64]


class Grounds:
    """Grounds by family, kept for as long as the pairs are the same."""

    def __init__(self) -> None:
        self._pairs = b""
        self._kept: dict[tuple[str, bool], Ground] = {}

    def of(self, family: Family, light: Array, view: Array, *, both_ways: bool) -> Ground:
        """Return the ground of pairs, unit vectors of shape (n, 3).

        Where they may breach reciprocity, `both_ways`, a pair and its reverse are two.
        """
        pairs = light.tobytes() + view.tobytes()
        if pairs != self._pairs:
            self._pairs, self._kept = pairs, {}
        key = family.name, both_ways
        if key not in self._kept:
            self._kept[key] = _ground(family, Pairs.of(light, view), both_ways=both_ways)
        return self._kept[key]


def _ground(family: Family, pairs: Pairs, *, both_ways: bool) -> Ground:
    distinct, which = family.distinct(pairs)
    if both_ways:
        distinct, which = _ordered(family, pairs, which)
    return Ground(family.traits(distinct), which)


def _ordered(
    family: Family, pairs: Pairs, which: NDArray[np.int64]
) -> tuple[Pairs, NDArray[np.int64]]:
    """Tell a pair from its reverse, which are one in `which`."""
    if not family.isotropic:
        return pairs, np.arange(len(pairs))
    higher = np.sign((pairs.light[:, 2] - pairs.view[:, 2]).round(7)).astype(np.int64)
    _, first, again = np.unique(3 * which + higher, return_index=True, return_inverse=True)
    return pairs.part(first), again.reshape(-1)
