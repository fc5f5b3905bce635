"""Checks of single frames and brackets: saturation, noise, lamps, exposures, blur and focus."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.checks import Check
from gonio.reduce.checks.chance import is_chance, remedy_for
from gonio.samples import Flag
from gonio.words import several

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.reduce.checks.seen import Seen
    from gonio.reduce.reading import Reading

FULL_MA: Final = 700.0
DIM: Final = 0.5
"""Share of what its current asks for below which a lamp counts as dead; heat takes some 15 %."""

STRAY: Final = 0.01
"""Flux above which a lamp that nobody lit counts as lit."""

DISAGREE: Final = 0.02
UNLIKELY: Final = 5.0
"""Share and number of standard deviations by which exposures of a shot may differ."""

SOFT_PX: Final = 1.5
SHAKEN_PX: Final = 1.0
"""Width of an edge in focus, and how much wider than in the others it may be in one shot."""

_SAME_TILT = np.radians(7.5)
_FACING = np.radians(35.0)
_FEWEST_PEERS = 3


def saturation(seen: Sequence[Seen]) -> Check:
    """Find shots that are saturated in every exposure."""
    clipped = [each.index for each in seen if (each.flag & Flag.CLIPPED).any()]
    return Check(
        name="saturation",
        ok=not clipped,
        found=f"{several(len(clipped), 'shot')} saturated in every exposure",
        limit="none",
        remedy="their values are lower bounds; plan shorter exposures" if clipped else "",
        shots=tuple(clipped),
    )


def noise(seen: Sequence[Seen]) -> Check:
    """Find shots that show nothing above their noise in any channel."""
    faint = [each.index for each in seen if (each.flag & Flag.FAINT).all()]
    return Check(
        name="noise",
        ok=not faint,
        found=f"{several(len(faint), 'shot')} with nothing above the noise",
        limit="none",
        remedy="plan longer exposures, or more light" if faint else "",
        shots=tuple(faint),
    )


def lamps(seen: Sequence[Seen], unlit: Sequence[int]) -> Check:
    """Find shots in which a lamp was dark that should shine, or the other way round.

    Parameters
    ----------
    seen
        The shots.
    unlit
        Indices of those that were left out since no light fell on the sample at all.
    """
    wrong = {each.index: lamp for each in seen if (lamp := _wrong_lamp(each))}
    shots = sorted({*unlit, *wrong})
    named = ", ".join(sorted(set(wrong.values())) or ["all dark"]) if shots else ""
    return Check(
        name="lamps",
        ok=not shots,
        found=f"{several(len(shots), 'shot')} lit otherwise than planned"
        + (f" ({named})" if named else ""),
        limit=f"flux above {DIM:.0%} of what the current asks for",
        remedy="mend the lamp, then take them again" if shots else "",
        shots=tuple(shots),
        retake=bool(shots),
    )


def _wrong_lamp(each: Seen) -> str:
    asked = np.zeros(11)
    for lamp in each.shot.lamps:
        asked[lamp.n - 1] = lamp.mA / FULL_MA
    for record in each.records:
        flux = np.array(record.flux)
        for n in np.flatnonzero(flux < DIM * asked):
            return f"lamp {n + 1} dim"
        for n in np.flatnonzero((asked == 0) & (flux > STRAY)):
            return f"lamp {n + 1} on"
    return ""


def exposures(seen: Sequence[Seen], gain: float) -> Check:
    """Find shots whose exposures disagree: an offset, a bend or a flicker that no noise explains.

    Parameters
    ----------
    seen
        The shots.
    gain
        Raw units per electron.
    """
    apart = [each.index for each in seen if _disagree(each.readings, gain)]
    return Check(
        name="exposures",
        ok=not apart,
        found=f"{several(len(apart), 'shot')} whose exposures disagree",
        limit=f"{DISAGREE:.0%} and {UNLIKELY:g} sigma",
        remedy=remedy_for(
            apart, seen, "the sensor bends, or its black level moved: run gonio calibrate"
        ),
        shots=tuple(apart),
        retake=is_chance(apart, seen),
    )


def _disagree(readings: Sequence[Reading], gain: float) -> bool:
    signal, exposure, pixels = (
        np.array([getattr(reading, name) for reading in readings])
        for name in ("signal", "exposure", "pixels")
    )
    read_variance = np.array([[reading.read_variance] for reading in readings])
    usable = np.array([~reading.saturated for reading in readings])
    together = np.where(usable, signal, 0.0).sum(axis=0) / np.maximum(
        np.where(usable, exposure, 0.0).sum(axis=0), np.finfo(float).tiny
    )
    expected = together * exposure
    sigma = np.sqrt((gain * np.clip(expected, 0.0, None) + read_variance) / pixels)
    off = np.abs(signal - expected)
    return bool((usable & (off > UNLIKELY * sigma) & (off > DISAGREE * np.abs(expected))).any())


def focus(seen: Sequence[Seen]) -> Check:
    """Judge the focus by the shots that look down on the sample."""
    widths = [
        each.blur_px
        for each in seen
        if each.blur_px is not None and np.arccos(min(each.view[2], 1.0)) < _FACING
    ]
    width = float(np.median(widths)) if widths else None
    ok = width is None or width <= SOFT_PX
    return Check(
        name="focus",
        ok=ok,
        found="no edge of the sample is seen well enough" if width is None
        else f"the sample's edge is {width:.2g} px wide",
        limit=f"{SOFT_PX:g} px",
        remedy="" if ok else "focus the camera on the sample and measure anew",
        asked=width is not None,
    )  # fmt: skip


def blur(seen: Sequence[Seen]) -> Check:
    """Find shots that are less sharp than others of the same tilt: something shook."""
    shaken = [each.index for each in seen if _is_shaken(each, seen)]
    return Check(
        name="blur",
        ok=not shaken,
        found=f"{several(len(shaken), 'shot')} shaken",
        limit=f"an edge {SHAKEN_PX:g} px wider than in the others",
        remedy=remedy_for(shaken, seen, "lower [arm] settle_limit_urad in the rig file"),
        shots=tuple(shaken),
        retake=is_chance(shaken, seen),
        asked=any(each.blur_px is not None for each in seen),
    )


def _is_shaken(each: Seen, seen: Sequence[Seen]) -> bool:
    if each.blur_px is None:
        return False
    widths = np.array([other.blur_px for other in seen if other.blur_px is not None])
    tilts = np.arccos([min(other.view[2], 1.0) for other in seen if other.blur_px is not None])
    peers = np.abs(tilts - np.arccos(min(each.view[2], 1.0))) < _SAME_TILT
    usual = widths[peers] if peers.sum() >= _FEWEST_PEERS else widths
    return bool(each.blur_px > np.median(usual) + SHAKEN_PX)
