"""Arm, lamps, camera and holder of a session's rig, put together for a RunEngine."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.bluesky.arm import ArmDevice
from gonio.bluesky.devices import CameraDevice, HolderDevice, LampsDevice
from gonio.bluesky.record import Record
from gonio.bluesky.status import Worker
from gonio.capture import check_reach, check_space
from gonio.capture.lighting import Lighting
from gonio.capture.wanted import Missing
from gonio.files import make_folder

if TYPE_CHECKING:
    from collections.abc import Iterator
    from contextlib import AbstractContextManager

    from gonio.capture import Instrument, Operator
    from gonio.journal import Journal
    from gonio.planchain import PlanChain
    from gonio.session import Session


@dataclass(frozen=True)
class Bench:
    """A session and the devices that measure it.

    Attributes
    ----------
    session, chain
        What is measured, and its plans.
    missing
        Which frames are still to be taken.
    arm, lamps, camera, holder
        Devices of Bluesky.
    """

    session: Session
    chain: PlanChain
    missing: Missing
    arm: ArmDevice
    lamps: LampsDevice
    camera: CameraDevice
    holder: HolderDevice


@contextlib.contextmanager
def bench(
    session: Session, driven: AbstractContextManager[tuple[Instrument, Operator]]
) -> Iterator[Bench]:
    """Connect to a rig, or its twin, and lock and journal the session meanwhile.

    Parameters
    ----------
    session
        A session as `gonio capture` begins it.
    driven
        What connects to the rig when it is entered, and is left in the same thread.

    Raises
    ------
    gonio.errors.GonioError
        When the plan cannot be measured, or the rig, the session or the disk is not to be had.
    """
    worker = Worker()
    with session.lock(), contextlib.ExitStack() as stack:
        stack.callback(worker.close)
        ours = worker.do(contextlib.ExitStack)
        stack.callback(worker.do, ours.close)
        yield worker.do(_put_together, session, driven, worker, ours)


def _put_together(
    session: Session,
    driven: AbstractContextManager[tuple[Instrument, Operator]],
    worker: Worker,
    ours: contextlib.ExitStack,
) -> Bench:
    chain, rig = session.chain(), session.rig()
    journal: Journal = ours.enter_context(session.journal(writing=True))
    missing = Missing(session, chain, journal.frames(), journal.rejected())
    todo = [shot for shot in chain.shots if missing.of_shot(shot)]
    check_reach(todo, rig)
    check_space(session.root, missing.count(todo), rig, "free some space")
    instrument, operator = ours.enter_context(driven)
    record = Record(session, chain, journal, missing, instrument.clock)
    for folder in (session.calibration, session.raw):
        make_folder(folder)  # it may have gone with all its frames
    lighting = Lighting(instrument.lamps, rig.lamps, instrument.clock)
    record.begin()
    ours.callback(record.end)
    instrument.troubles.listener = record.fault
    return Bench(
        session=session,
        chain=chain,
        missing=missing,
        arm=ArmDevice(instrument, rig, worker, record),
        lamps=LampsDevice(lighting, instrument, worker),
        camera=CameraDevice(session, instrument, journal, missing, worker),
        holder=HolderDevice(lighting, instrument, operator, worker),
    )
