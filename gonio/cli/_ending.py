"""A capture in the terminal: its bars, its rounds, what it met, and how it ended."""

from __future__ import annotations

import contextlib
from dataclasses import asdict
from functools import partial
from typing import TYPE_CHECKING

from gonio.api.following import Following
from gonio.api.measuring import NOT_NOTED, Measured
from gonio.api.rehearsal import concluded
from gonio.api.told import session_document
from gonio.cli._console import console, note, progress_bar
from gonio.cli._json import answer
from gonio.words import duration, several

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.adaptive import Goal, Round
    from gonio.api.capturing import Ready
    from gonio.journal import Journal
    from gonio.session import Session


def take(ready: Ready, *, retake: bool) -> None:
    """Take what a session lacks, and say how that went."""
    following = Following(
        bars=progress_bar,
        tell=note,
        told=partial(_tell_round, goal=ready.goal),
        given_up=lambda count: console.print(f"{several(count, 'flagged shot')} to take again"),
        meeting=_tell_faults,
        using=_tell_usage,
    )
    session, taken = ready.session, ready.capture(following, retake=retake)
    if isinstance(taken, Measured):
        _conclude(session, taken)
    else:
        _conclude_rounds(session, taken)
    onward = None if session.notes().rehearsal else session.reconstruct_command
    answer({**session_document(session), **asdict(taken), "next": onward})


@contextlib.contextmanager
def _tell_faults(journal: Journal) -> Iterator[None]:
    """Say, however the work within ends, how many faults it met and where."""
    from gonio.faultlog import faults_of, spoken

    before = len(faults_of(journal))
    try:
        yield
    finally:
        met = faults_of(journal)[before:]
        if met:
            console.print(f"faults met: {spoken(met)}; each is in the journal")


@contextlib.contextmanager
def _tell_usage(journal: Journal) -> Iterator[None]:
    """Say, however the captures within end, what the rig's time went into."""
    from gonio.capture.usage import Usage, usages_of

    before = len(usages_of(journal))
    try:
        yield
    finally:
        runs = usages_of(journal)[before:]
        if runs:
            console.print(f"rig in use {Usage.sum(runs).sentence}")


def _conclude(session: Session, taken: Measured) -> None:
    if not taken.frames:
        console.print(f"{session.root}: nothing left to take; the session is complete")
        return
    notes = session.notes()
    sample = notes.sample.removesuffix(" (simulated)")
    name = "the sample" if sample == NOT_NOTED else sample
    done = f"{taken.frames} frames {'rehearsed' if notes.rehearsal else f'of {name}'}"
    console.print(
        f"{session.root}: {done} in {duration(taken.rig_s)} of rig time "
        f"(whole plan estimated at {duration(session.chain().estimated_s)})"
    )
    _tell_score(session)
    command = f"next: {session.reconstruct_command}"
    console.print(concluded(taken.wall_s) if notes.rehearsal else command)


def _tell_round(state: Round, goal: Goal | None) -> None:
    target = f" (target {goal.until:g})" if goal else ""
    console.print(
        f"round {state.number}: {state.shots} shots, mean sd {state.deviation:.3f}{target}, "
        f"{duration(state.rig_s)} of rig time"
    )


def _conclude_rounds(session: Session, last: Round) -> None:
    console.print(
        f"{session.root}: {last.ended}: mean sd {last.deviation:.3f} after {last.shots} shots in "
        f"{last.number} plans, {duration(last.rig_s)} of rig time"
    )
    _tell_score(session)
    console.print(f"next: {session.reconstruct_command}")


def _tell_score(session: Session) -> None:
    from gonio.score import score_of

    if (score := score_of(session)) is not None:
        console.print(f"that is {score.sentence}")
