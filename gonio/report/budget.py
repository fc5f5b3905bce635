"""What sigma is made of, in shares of its square."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.uncertainty import COMPONENTS

if TYPE_CHECKING:
    from gonio.samples import Samples


class Part(NamedTuple):
    """A component and its share of the variance, the mean over all values that have a sigma."""

    name: str
    meaning: str
    common: bool
    share: float


def parts_of(samples: Samples) -> list[Part]:
    """Return the parts of samples' sigma; none where the samples do not tell them."""
    known = samples.sigma > 0
    if not samples.components or not known.any():
        return []
    variance = samples.sigma[known] ** 2
    return [
        Part(each.name, each.meaning, each.common, float(np.mean(part[known] ** 2 / variance)))
        for each in COMPONENTS
        if (part := samples.components.get(each.name)) is not None
    ]
