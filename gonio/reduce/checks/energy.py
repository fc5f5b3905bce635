"""Checks of samples against what a surface can do: neither below nothing, nor above all."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.checks import Check
from gonio.reduce.checks.chance import is_chance, remedy_for
from gonio.reduce.checks.pairs import pair_of
from gonio.words import several

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.reduce.checks.seen import Seen

BELOW: Final = 5.0
"""Number of standard deviations below zero from which noise no longer explains a value."""

FEWEST_VIEWS: Final = 9
"""Views of one light that tell its albedo roughly."""

_NODES = 4000
_GOLDEN = np.pi * (3.0 - np.sqrt(5.0))


def negative(seen: Sequence[Seen]) -> Check:
    """Find values below zero that noise does not explain."""
    below = [each.index for each in seen if (each.value < -BELOW * each.sigma).any()]
    systematic = "the dark frames are brighter than the shots: darken the room, calibrate anew"
    return Check(
        name="negative",
        ok=not below,
        found=f"{several(len(below), 'shot')} below zero",
        limit=f"{BELOW:g} sigma",
        remedy=remedy_for(below, seen, systematic),
        shots=tuple(below),
        retake=is_chance(below, seen),
    )


def albedo(seen: Sequence[Seen]) -> Check:
    """Find directions of light from which more comes back than arrives.

    The views of one light are summed by the share of the projected hemisphere that each is next
    to, on which the cosine-weighted solid angle is uniform. A few views may be in a highlight much
    narrower than what lies next to them, so twice the root of the sum of squares is taken off.
    """
    by_light = defaultdict(list)
    for each in seen:
        by_light[pair_of(each)[0]].append(each)
    enough = [group for group in by_light.values() if len(group) >= FEWEST_VIEWS]
    sums = [_albedo(group) for group in enough]
    above = [value for value, sigma in sums if value > 1.0 + BELOW * sigma]
    largest = max((value for value, _ in sums), default=None)
    return Check(
        name="albedo",
        ok=not above,
        found=f"no light has {FEWEST_VIEWS} views" if largest is None
        else f"at least {largest:.2f} for one of {several(len(sums), 'light')}",
        limit="1",
        remedy="check the white reference and its BRDF" if above else "",
        asked=largest is not None,
    )  # fmt: skip


def _albedo(group: Sequence[Seen]) -> tuple[float, float]:
    """Return what the albedo for one light is at least, in the brightest channel, and its sigma."""
    value, sigma = (
        np.array([getattr(each, name) for each in group]) for name in ("value", "sigma")
    )
    weight = _weights(np.array([each.view[:2] for each in group]))
    parts = weight[:, None] * value
    at_least = np.maximum(parts.sum(axis=0) - 2.0 * np.sqrt((parts**2).sum(axis=0)), 0.0)
    channel = int(np.argmax(at_least))
    return float(at_least[channel]), float(weight @ sigma[:, channel])


def _weights(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the area of the unit disc that is nearest to each place, shape (n, 2) to (n,)."""
    from scipy.spatial import KDTree

    step = np.arange(_NODES)
    radius, turn = np.sqrt((step + 0.5) / _NODES), _GOLDEN * step
    nodes = np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)
    nearest = KDTree(places).query(nodes)[1]
    return np.asarray(np.pi * np.bincount(nearest, minlength=len(places)) / _NODES)
