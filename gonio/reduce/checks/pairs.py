"""Checks of samples against each other: repeated shots, and light and view exchanged."""

from __future__ import annotations

from collections import defaultdict
from itertools import combinations
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from gonio.checks import Check
from gonio.reduce.checks.chance import is_chance, remedy_for
from gonio.samples import Flag
from gonio.words import several

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from gonio.reduce.checks.seen import Seen

    Pair = tuple[Seen, Seen]

REPEATED: Final = 0.02
EXCHANGED: Final = 0.05
"""Share by which two samples of one pair, and of an exchanged one, may differ."""

UNLIKELY: Final = 4.0
"""Number of standard deviations by which they may; only of what does not cancel in them."""

# what all shots share and what yet errs otherwise where light and view are exchanged
_BY_DIRECTIONS: Final = ("dark", "calibration", "shutter", "angle", "alignment", "stray")


class Direction(NamedTuple):
    """A direction of the plan in hundredths of a degree, by which shots are of one pair."""

    theta: int
    phi: int


def pair_of(each: Seen) -> tuple[Direction, Direction]:
    """Return light and view as planned."""
    light, view = (
        Direction(*(round(100 * angle) for angle in each.shot.direction_deg(side)))
        for side in ("light", "view")
    )
    return light, view


def of_one_pair(seen: Sequence[Seen]) -> list[list[Seen]]:
    """Return the shots that repeat one pair, as groups of at least two."""
    groups = defaultdict(list)
    for each in seen:
        groups[pair_of(each)].append(each)
    return [group for group in groups.values() if len(group) > 1]


def repeats(seen: Sequence[Seen]) -> Check:
    """Compare shots of one pair of directions, each with each."""
    groups = of_one_pair(seen)
    pairs = [pair for group in groups for pair in combinations(group, 2)]
    apart = [pair for pair in pairs if differ(*pair, REPEATED)]
    systematic = "the rig does not repeat: see drift and lamps"
    return _told("repeats", pairs, apart, REPEATED, systematic)


def reciprocity(seen: Sequence[Seen]) -> Check:
    """Compare pairs measured both ways round (Helmholtz reciprocity)."""
    first: dict[tuple[Direction, Direction], Seen] = {}
    for each in seen:
        first.setdefault(pair_of(each), each)
    both_ways = [
        (each, first[view, light])
        for (light, view), each in first.items()
        if light < view and (view, light) in first
    ]
    apart = [pair for pair in both_ways if differ(*pair, EXCHANGED, _BY_DIRECTIONS)]
    systematic = (
        "the arms' angles, the light's evenness or the sample's place are off, or the sample is "
        "not reciprocal"
    )
    return _told("reciprocity", both_ways, apart, EXCHANGED, systematic)


def _told(
    name: str, pairs: Sequence[Pair], apart: Sequence[Pair], share: float, systematic: str
) -> Check:
    shots = sorted({each.index for pair in apart for each in _odd(pair, apart)})
    within = f"median difference {np.median([_difference(*p) for p in pairs]):.2%}" if pairs else ""
    return Check(
        name=name,
        ok=not apart,
        found=", ".join(filter(None, [f"{len(apart)} of {several(len(pairs), 'pair')} differ",
                                      within])),
        limit=f"{share:.0%} and {UNLIKELY:g} sigma",
        remedy=remedy_for(apart, pairs, systematic),
        shots=tuple(shots),
        retake=is_chance(apart, pairs),
        asked=bool(pairs),
    )  # fmt: skip


def _odd(pair: Pair, apart: Sequence[Pair]) -> Iterable[Seen]:
    """Return which of a pair is the odd one: the one that differs from more, or both."""
    counts = [sum(each in other for other in apart) for each in pair]
    return [each for each, count in zip(pair, counts, strict=True) if count == max(counts)]


def differ(one: Seen, other: Seen, share: float, also: Sequence[str] = ()) -> bool:
    """Tell whether a channel differs by more than `share` and than noise explains.

    `also` are components that all shots share, and that do not cancel in these two.
    """
    apart = np.abs(one.value - other.value)
    clipped = (one.flag | other.flag) & Flag.CLIPPED
    beyond = apart > UNLIKELY * np.hypot(one.scatter(*also), other.scatter(*also))
    beyond &= apart > share * (np.abs(one.value) + np.abs(other.value)) / 2
    return bool((beyond & (clipped == 0)).any())


def _difference(one: Seen, other: Seen) -> float:
    total = np.abs(one.value + other.value).sum() / 2
    return float(np.abs((one.value - other.value).sum()) / total) if total else 0.0
