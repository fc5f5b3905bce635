"""A twin's transports with faults on them, as a driver is given them."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from sim.faults.bus import FaultyBus
from sim.faults.drives import FaultyDrives
from sim.faults.folder import FaultyFolder
from sim.faults.head import FaultyHead
from sim.faults.injector import Injector
from sim.faults.line import FaultyLine
from sim.faults.mishaps import Mishaps

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from gonio.clock import VirtualClock
    from gonio.rig import Rig
    from gonio.transports import FrameFolder, RegisterBus, SerialLine
    from sim.faults.document import Fault
    from sim.twin import Twin


class Wires(NamedTuple):
    """What lies between drivers and a rig, and how often each kind of fault has struck it."""

    bus: RegisterBus
    line: SerialLine
    folder: FrameFolder
    struck: Mapping[str, int] = MappingProxyType({})


class Ends(NamedTuple):
    """A rig's ends of its wires, to which things happen, and what says when they do.

    Attributes
    ----------
    bus, line
        To drives and lamp head.
    axes
        Name of the axis of each unit of the bus.
    injector
        For what happens between these ends and the drivers'.
    """

    bus: RegisterBus
    line: SerialLine
    axes: Mapping[int, str]
    injector: Injector


def faulty_ends(
    twin: Twin, rig: Rig, clock: VirtualClock, faults: Iterable[Fault], seed: int
) -> Ends:
    """Return a twin's ends of its wires, and let things happen to the twin itself."""
    injector = Injector(faults, clock, seed)
    mishaps = Mishaps(twin, clock, injector)
    axes = {rig.axis[name].unit: name for name in twin.drives}
    return Ends(
        FaultyDrives(twin.bus, axes, injector, mishaps),
        FaultyHead(twin.line, clock, injector, mishaps),
        axes,
        injector,
    )


def faulty_wires(
    twin: Twin,
    rig: Rig,
    folder: FrameFolder,
    clock: VirtualClock,
    faults: Iterable[Fault],
    seed: int,
) -> Wires:
    """Return a twin's transports with faults on them, which also let things happen to the twin."""
    ends = faulty_ends(twin, rig, clock, faults, seed)
    return Wires(
        FaultyBus(ends.bus, ends.axes, clock, ends.injector),
        FaultyLine(ends.line, clock, ends.injector),
        FaultyFolder(folder, clock, ends.injector),
        ends.injector.struck,
    )
