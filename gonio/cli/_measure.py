"""Taking what a session lacks, and saying how that went."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from contextlib import AbstractContextManager

    from gonio.capture import Instrument, Operator
    from gonio.cli._twin import TwinSettings
    from gonio.session import Session
    from sim.faults import Fault

    Driven = AbstractContextManager[tuple[Instrument, Operator]]

NOT_NOTED = "not noted"


def driven(session: Session, twin: TwinSettings | None, faults: Sequence[Fault]) -> Driven:
    """Return what connects to the rig, or to its twin, when it is entered."""
    if twin is None:
        from gonio.capture.hardware import hardware

        return hardware(session.rig(), session.clock_s())
    from gonio.cli._twin import simulated

    return simulated(session, twin, faults)


def measure(session: Session, driven: Driven) -> None:
    """Take every frame that is missing, with the rig that `driven` connects to."""
    from gonio.capture import Capture
    from gonio.cli._console import progress_bar
    from gonio.cli._ending import tell_faults, tell_usage
    from gonio.wishes import heeding

    began = time.perf_counter()
    with (
        session.lock(),
        heeding(session.root),
        session.journal(writing=True) as journal,
        driven as (instrument, operator),
        progress_bar("capturing") as progress,
    ):
        start_s = instrument.clock.now()
        with tell_faults(journal), tell_usage(journal):
            frames = Capture(session, instrument, operator, journal).run(progress)
        took_s = instrument.clock.now() - start_s
        wall_s = time.perf_counter() - began
        if frames:
            session.note_timing("capture", session.timings().get("capture", 0.0) + wall_s)
    _report(session, frames, took_s, wall_s)


def _report(session: Session, frames: int, took_s: float, wall_s: float) -> None:
    from gonio.cli._console import console
    from gonio.cli._rehearsal import concluded
    from gonio.score import score_of
    from gonio.words import duration

    if not frames:
        console.print(f"{session.root}: nothing left to take; the session is complete")
        return
    chain, sample = session.chain(), session.notes().sample.removesuffix(" (simulated)")
    name = "the sample" if sample == NOT_NOTED else sample
    rehearsed = session.notes().rehearsal
    done = f"{frames} frames {'rehearsed' if rehearsed else f'of {name}'}"
    console.print(
        f"{session.root}: {done} in {duration(took_s)} of rig time "
        f"(whole plan estimated at {duration(chain.estimated_s)})"
    )
    if (score := score_of(session)) is not None:
        console.print(f"that is {score.sentence}")
    console.print(concluded(wall_s) if rehearsed else f"next: {session.reconstruct_command}")
