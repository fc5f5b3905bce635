"""Checks of what must not change through a scan: repeated anchors, and the holder's squares."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.checks import Check
from gonio.reduce.checks.chance import is_chance, remedy_for
from gonio.reduce.checks.pairs import of_one_pair
from gonio.words import several

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.reduce.checks.seen import Seen

DRIFT: Final = 0.02
UNLIKELY: Final = 4.0
"""Share and number of standard deviations by which a scan's end may differ from its beginning."""

OFF: Final = 0.1
OUTLYING: Final = 6.0
"""Share and number of deviations by which the squares of one shot may differ from the others."""

_FEWEST_ANCHORS = 3
_FEWEST_SQUARES = 12
_ROUNDS = 20
_MAD = 1.4826
_REMEDY = "let the rig warm up, calibrate and measure anew"


def anchors(seen: Sequence[Seen]) -> Check:
    """Fit a line through time to the pairs that were repeated most."""
    group = max(of_one_pair(seen), key=len, default=[])
    if len(group) < _FEWEST_ANCHORS:
        found = f"fewer than {_FEWEST_ANCHORS} repeats of a pair (gonio plan --anchors 50)"
        return Check(name="drift", ok=True, found=found, limit=f"{DRIFT:.0%}", asked=False)
    level = np.array([each.value.mean() for each in group])
    share = np.array([np.linalg.norm(each.scatter()) / 3 for each in group]) / level.mean()
    constant = np.ones((len(group), 1))
    change, sigma = _change(_time(group, seen), level / level.mean(), share, constant)
    return _drifted("drift", f"of {len(group)} repeats of a pair", change, sigma)


def squares(seen: Sequence[Seen]) -> tuple[Check, Check]:
    """Judge the holder's white squares, through time and shot by shot.

    How the paper's BRDF depends on the directions is taken out by what it does over all shots.

    Returns
    -------
    tuple of Check
        Of the drift, and of shots that are off.
    """
    usable = [each for each in seen if each.holder is not None]
    if len(usable) < _FEWEST_SQUARES:
        found = f"seen in {several(len(usable), 'shot')}, too few to tell"
        return (
            Check(name="drift of holder", ok=True, found=found, limit=f"{DRIFT:.0%}", asked=False),
            Check(name="holder", ok=True, found=found, limit=f"{OFF:.0%}", asked=False),
        )
    terms = _terms(usable)
    rest, sigma, scatter, kept = _rest(usable, terms)
    limit = np.maximum(OFF, OUTLYING * np.hypot(scatter, sigma))
    off = [usable[place].index for place in np.flatnonzero(np.abs(rest) > limit)]
    time = _time(usable, seen)
    noise = np.hypot(scatter, sigma)
    change, change_sigma = _change(time[kept], 1.0 + rest[kept], noise[kept], terms[kept])
    systematic = "something is before the board in many shots: clear it away"
    return (
        _drifted(
            "drift of holder", f"of the white squares in {len(usable)} shots", change, change_sigma
        ),
        Check(
            name="holder",
            ok=not off,
            found=f"{several(len(off), 'shot')} with white squares brighter or darker than usual",
            limit=f"{OFF:.0%}",
            remedy=remedy_for(off, usable, systematic),
            shots=tuple(off),
            retake=is_chance(off, usable),
        ),
    )


def _drifted(name: str, of_what: str, change: float, sigma: float) -> Check:
    ok = abs(change) <= max(DRIFT, UNLIKELY * sigma)
    return Check(
        name=name,
        ok=ok,
        found=f"{change:+.2%} +- {sigma:.2%} from first to last, {of_what}",
        limit=f"{DRIFT:.0%} and {UNLIKELY:g} sigma",
        remedy="" if ok else _REMEDY,
    )


def _time(group: Sequence[Seen], seen: Sequence[Seen]) -> NDArray[np.float64]:
    """Return when shots were taken, from 0 to 1 through the scan."""
    every = [each.taken for each in seen]
    span = max(every) - min(every) or 1
    return np.array([each.taken - min(every) for each in group]) / span


def _change(
    time: NDArray[np.float64],
    level: NDArray[np.float64],
    sigma: NDArray[np.float64],
    terms: NDArray[np.float64],
) -> tuple[float, float]:
    """Return the slope in time of a weighted fit of time and `terms`, and its deviation.

    That is by the noise, or by the scatter about the fit where this is larger.
    """
    weight = 1.0 / np.maximum(sigma, 1e-6)
    matrix = weight[:, None] * np.hstack([time[:, None], terms])
    found = np.linalg.pinv(matrix) @ (weight * level)
    free = max(len(level) - np.linalg.matrix_rank(matrix), 1)
    scatter = float((((weight * level) - matrix @ found) ** 2).sum()) / free
    variance = np.linalg.pinv(matrix.T @ matrix)[0, 0] * max(scatter, 1.0)
    return float(found[0]), float(np.sqrt(variance))


def _terms(usable: Sequence[Seen]) -> NDArray[np.float64]:
    """Return what the paper's BRDF may depend on, shape (n, 4)."""
    light, view = (np.array([getattr(each, name) for each in usable]) for name in ("light", "view"))
    terms = [np.ones(len(light)), light[:, 2], view[:, 2], (light * view).sum(axis=1)]
    return np.stack(terms, axis=1)


def _rest(
    usable: Sequence[Seen], terms: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], float, NDArray[np.bool_]]:
    """Return by which share levels differ from what their directions let expect, and its noise.

    Further their scatter by the median absolute deviation, and which shots are no outliers. The
    fit has the least sum of absolute rests, which outliers do not move, by reweighting.
    """
    looks = [each.holder for each in usable if each.holder is not None]
    level, noise = (
        np.array([getattr(look, name) for look in looks]) for name in ("level", "sigma")
    )
    usual = float(np.median(level))
    rest = level / usual - 1.0
    for _ in range(_ROUNDS):
        weight = 1.0 / np.sqrt(np.maximum(np.abs(rest), 1e-4))
        found = np.linalg.lstsq(weight[:, None] * terms, weight * level, rcond=None)[0]
        expected = np.maximum(terms @ found, 0.1 * usual)
        rest = level / expected - 1.0
    sigma = noise / expected
    scatter = float(_MAD * np.median(np.abs(rest)))
    return rest, sigma, scatter, np.abs(rest) <= OUTLYING * np.hypot(scatter, sigma)
