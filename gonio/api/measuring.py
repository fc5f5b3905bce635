"""Taking what a session lacks, on the rig or on its twin."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from contextlib import AbstractContextManager

    from gonio.api.following import Following
    from gonio.api.twin import TwinSettings
    from gonio.capture import Instrument, Operator
    from gonio.session import Session
    from sim.faults import Fault

    Driven = AbstractContextManager[tuple[Instrument, Operator]]

NOT_NOTED = "not noted"


@dataclass(frozen=True)
class Measured:
    """What a capture took: frames, seconds of the rig and of the clock on the wall."""

    frames: int
    rig_s: float
    wall_s: float


def driven(session: Session, twin: TwinSettings | None, faults: Sequence[Fault]) -> Driven:
    """Return what connects to the rig, or to its twin, when it is entered."""
    if twin is None:
        from gonio.capture.hardware import hardware

        return hardware(session.rig(), session.clock_s())
    from gonio.api.twin import simulated

    return simulated(session, twin, faults)


def measure(session: Session, driven: Driven, following: Following) -> Measured:
    """Take every frame that is missing, with the rig that `driven` connects to."""
    from gonio.capture import Capture
    from gonio.reduce.camera_check import check_camera
    from gonio.wishes import heeding

    began = time.perf_counter()
    with (
        session.lock(),
        heeding(session.root),
        session.journal(writing=True) as journal,
        driven as (instrument, operator),
        following.bars("capturing") as progress,
    ):
        start_s = instrument.clock.now()
        with following.meeting(journal), following.using(journal):
            judge = partial(check_camera, session, journal)
            frames = Capture(session, instrument, operator, journal, judge).run(progress)
        took_s = instrument.clock.now() - start_s
        wall_s = time.perf_counter() - began
        if frames:
            session.note_timing("capture", session.timings().get("capture", 0.0) + wall_s)
    return Measured(frames, took_s, wall_s)
