"""Which directions were chosen, and which were skipped, as discs seen from above."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.directions import paper_angles_deg, to_degrees

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from gonio.plan import Plan, Side
    from gonio.report.sources import Sources
    from gonio.samples import Samples

    Angles = tuple[float, float]

_LEAST, _MOST = 2.0, 4.2


class Dot(NamedTuple):
    """A direction: the radius is theta in degrees, the marked edge to the right, y downwards.

    `later` tells whether a further plan added it.
    """

    x: float
    y: float
    radius: float
    later: bool


class Disc(NamedTuple):
    """The hemisphere of one side, with its title and caption."""

    title: str
    caption: str
    chosen: list[Dot]
    skipped: list[Dot]


def discs_of(sources: Sources) -> Iterator[Disc]:
    """Yield where lights and views were planned, or, where there is no plan, measured."""
    for side in ("light", "view"):
        title = f"{side} directions".capitalize()
        if sources.chain:
            yield _planned(title, sources.chain.plans, side)
        else:
            yield _measured(title, sources.samples, side)


def _planned(title: str, plans: Sequence[Plan], side: Side) -> Disc:
    first = {shot.direction_deg(side) for shot in plans[0].shots}
    shots = Counter(shot.direction_deg(side) for plan in plans for shot in plan.shots)
    theta, phi = paper_angles_deg()
    candidates = list(zip(theta.tolist(), phi.tolist(), strict=True))
    skipped = [angles for angles in candidates if not _among(angles, shots)]
    caption = (
        f"{len(shots)} chosen of {len(candidates)} (filled, the larger the more shots), "
        f"{len(skipped)} skipped (open)."
    )
    if len(first) < len(shots):
        caption += " Orange: added by further plans."
    return Disc(title, caption, _dots(shots, first), [_dot(each, _LEAST) for each in skipped])


def _measured(title: str, samples: Samples, side: Side) -> Disc:
    # a thousandth is well above the repeatability of an arm and below any spacing of directions
    count = len(np.unique(getattr(samples, side).round(3), axis=0))
    theta, phi = to_degrees(getattr(samples, side).round(3))
    # a dot a degree is all that can be seen of very many
    shots = Counter(zip(theta.round().tolist(), phi.round().tolist(), strict=True))
    return Disc(title, f"{count} directions.", _dots(shots, set(shots)), [])


def _among(angles: Angles, shots: Counter[Angles]) -> bool:
    return any(max(abs(a - b) for a, b in zip(angles, each, strict=True)) < 0.1 for each in shots)


def _dots(shots: Counter[Angles], first: set[Angles]) -> list[Dot]:
    most = max(shots.values())
    return [
        _dot(angles, _LEAST + (_MOST - _LEAST) * count / most, later=angles not in first)
        for angles, count in shots.items()
    ]


def _dot(angles: Angles, radius: float, *, later: bool = False) -> Dot:
    theta_deg, phi = angles[0], np.radians(angles[1])
    x, y = theta_deg * np.cos(phi), -theta_deg * np.sin(phi)
    return Dot(round(float(x), 2), round(float(y), 2), round(radius, 2), later)
