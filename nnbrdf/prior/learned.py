"""Materials that were measured before: examples for the prior, as the networks that tell them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.halfway import HALFWAY
from nnbrdf.prior.log import OFFSET

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nnbrdf.network import Networks
    from nnbrdf.prior.geometry import Pairs

    Array = NDArray[np.float64]

_LEAST = 1e-6
_LARGEST = 50.0


@dataclass(frozen=True)
class LearnedMaterial:
    """One material as a network that says ln(value / scale + 0.01) of its channels.

    Attributes
    ----------
    network
        A stack of one.
    encoding
        Its inputs, a name of `nnbrdf.halfway.HALFWAY`.
    tint
        What each output is multiplied with, shape (outputs,).
    source, sha256
        The folder of its model, and the SHA-256 of the weights there; empty where not known.
    """

    network: Networks
    encoding: str
    tint: Array
    source: str = ""
    sha256: str = ""

    @property
    def isotropic(self) -> bool:
        """Whether it knows azimuths by their difference only."""
        return self.encoding.startswith("isotropic")

    def evaluate(self, pairs: Pairs) -> Array:
        """Return the mean of its channels, positive and reciprocal, up to its scale, (n,).

        Of both orders of light and view it is the geometric mean: the prior's own breach of
        reciprocity is a part of its own.
        """
        there, back = (
            np.log(self._one_way(*order))
            for order in ((pairs.light, pairs.view), (pairs.view, pairs.light))
        )
        return np.asarray(np.exp(0.5 * (there + back)))

    def _one_way(self, light: Array, view: Array) -> Array:
        log = self.network.forward(HALFWAY[self.encoding](light, view))[0]
        value = (np.exp(log.clip(max=_LARGEST)) - OFFSET).clip(_LEAST)
        return np.asarray((value * self.tint).mean(axis=1))
