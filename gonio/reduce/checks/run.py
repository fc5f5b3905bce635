"""All checks of a session, and which shots they offer for a retake."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from gonio.checks import Check, Checks, Suspect
from gonio.reduce.checks import drift, energy, frames, light, pairs
from gonio.reduce.checks.seen import Seen
from gonio.reduce.provenance import newest_of_shot
from gonio.reduce.reading import UnlitError
from gonio.words import several

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from gonio.errors import BadInputError
    from gonio.journal import FrameRecord
    from gonio.reduce.calibrate import Calibration
    from gonio.reduce.checks.seen import Measured
    from gonio.rig import Rig


def run_checks(
    rows: Sequence[Measured],
    left_out: Mapping[int, BadInputError],
    records: Sequence[FrameRecord],
    calibration: Calibration,
    rig: Rig,
    made_from: str,
) -> Checks:
    """Put every question to a session.

    Parameters
    ----------
    rows
        The shots of which there are samples.
    left_out
        Why there is none of the others, by shot.
    records
        The journal's frames, oldest first.
    calibration
        What dark and white frames told.
    rig
        What the rig file states.
    made_from
        SHA-256 of the frames.
    """
    places = {record.file: place for place, record in enumerate(records)}
    seen = [Seen.of(row, min(places[record.file] for record in row.records)) for row in rows]
    unlit = {
        index: newest_of_shot(records, index)
        for index, error in left_out.items()
        if isinstance(error, UnlitError)
    }
    checks = (
        *_checks(seen, calibration.gain, list(unlit), sorted(left_out.keys() - unlit.keys())),
        light.warmth(seen, calibration.response.readings, rig.uncertainty.lamp_color),
    )
    taken_as = {each.index: each.records for each in seen} | unlit
    return Checks(frames=made_from, checks=checks, suspects=_suspects(checks, taken_as))


def _checks(
    seen: Sequence[Seen], gain: float, unlit: Sequence[int], left_out: Sequence[int]
) -> tuple[Check, ...]:
    return (
        _complete(left_out),
        frames.saturation(seen),
        frames.noise(seen),
        frames.lamps(seen, unlit),
        frames.exposures(seen, gain),
        frames.focus(seen),
        frames.blur(seen),
        energy.negative(seen),
        energy.albedo(seen),
        pairs.repeats(seen),
        pairs.reciprocity(seen),
        drift.anchors(seen),
        *drift.squares(seen),
    )


def _complete(left_out: Sequence[int]) -> Check:
    return Check(
        name="complete",
        ok=not left_out,
        found=f"{several(len(left_out), 'shot')} without a sample",
        limit="none",
        remedy="the warning says why" if left_out else "",
        shots=tuple(left_out),
    )


def _suspects(
    checks: Sequence[Check], taken_as: Mapping[int, tuple[FrameRecord, ...]]
) -> tuple[Suspect, ...]:
    problems = defaultdict(list)
    for check in checks:
        for shot in check.shots if check.retake else ():
            problems[shot].append(check.name)
    return tuple(
        Suspect(
            shot=shot,
            files=tuple(record.file for record in records),
            problem=", ".join(problems[shot]),
        )
        for shot, records in taken_as.items()
        if shot in problems
    )
