"""The devices that a capture drives, and the person who changes the sample."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

from gonio.devices import (
    Arm,
    AttendedClock,
    FolderCamera,
    LampHead,
    MeanwhileClock,
    TetheredCamera,
    Troubles,
)
from gonio.errors import GonioError
from gonio.paths import free_way
from gonio.rig import AXES
from gonio.transports import CameraPort

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from gonio.clock import Clock
    from gonio.devices import Camera
    from gonio.rig import Rig
    from gonio.transports import FrameFolder, RegisterBus, SerialLine

Holder = Literal["reference", "sample"]


class Operator(Protocol):
    """Whoever lays the white reference or the sample under the camera.

    Attributes
    ----------
    by_hand
        Whether hands, or a machine's, reach into the rig for as long as it takes: then lamps are
        off and drives let go meanwhile.
    """

    by_hand: bool

    def place(self, what: Holder) -> None:
        """Return when `what` lies in the holder."""


@dataclass(frozen=True)
class Instrument:
    """Arm, lamps and camera on one clock.

    Attributes
    ----------
    troubles
        Hears what the drivers met.
    meanwhile
        Has an errand run while arms move or lamps warm up.
    """

    arm: Arm
    lamps: LampHead
    camera: Camera
    clock: Clock
    troubles: Troubles
    meanwhile: MeanwhileClock

    @classmethod
    def of(
        cls,
        bus: RegisterBus,
        line: SerialLine,
        files: FrameFolder | CameraPort,
        rig: Rig,
        clock: Clock,
    ) -> Instrument:
        """Put the drivers of a rig together on its wires, of which the camera's is of one kind."""
        troubles, meanwhile = Troubles(), MeanwhileClock(clock)
        arm = Arm(bus, rig, clock, troubles, meanwhile)
        # whoever waits long, for lamps or files, has the drives hear that the host lives
        waiting = AttendedClock(meanwhile, arm.try_to_attend)
        lamps = LampHead(line, rig, waiting, troubles)
        camera: Camera = (
            TetheredCamera(files, lamps, rig, waiting, troubles)
            if isinstance(files, CameraPort)
            else FolderCamera(files, lamps, rig, waiting)
        )
        return cls(
            arm=arm,
            lamps=lamps,
            camera=camera,
            clock=waiting,
            troubles=troubles,
            meanwhile=meanwhile,
        )

    def begin(self) -> None:
        """Greet lamps and camera, enable the axes, and home those that do not know where they are.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When a device fails.
        """
        self.lamps.identify()
        self.camera.prepare()
        self.arm.enable()
        self.arm.home()

    def place(self, operator: Operator, what: Holder) -> None:
        """Have something laid into the holder; errors as for `begin`, and those of the operator."""
        if operator.by_hand:
            self.lamps.off()
            self.arm.release()
        operator.place(what)
        if operator.by_hand:
            self.arm.enable()

    def move_clear(self, angles_deg: Mapping[str, float], rig: Rig) -> None:
        """Move all axes from where the arms are by a way on which nothing comes too near.

        Raises
        ------
        gonio.errors.BadInputError
            When there is no such way.
        gonio.errors.DeviceFaultError
            As `gonio.devices.Arm.move`.
        """
        here = self.arm.angles_deg()
        start, goal = ([angles[name] for name in AXES] for angles in (here, angles_deg))
        way = free_way(start, goal, rig)
        *via, last = [dict(zip(AXES, pose, strict=True)) for pose in way.poses_deg.tolist()]
        self.arm.move(last, via)

    @contextlib.contextmanager
    def arm_ready(self) -> Iterator[Arm]:
        """Enable the arm alone; leave its axes stopped and disabled, whatever happens."""
        try:
            self.arm.enable()
            yield self.arm
        except BaseException:
            with contextlib.suppress(GonioError):
                self._leave(self.arm.stop, self.arm.release)
            raise
        self._leave(self.arm.release)

    @contextlib.contextmanager
    def ready(self, begin: Callable[[], None] | None = None) -> Iterator[None]:
        """Enable and home everything; leave axes disabled and lamps off, whatever happens.

        `begin` does so in place of the method of that name.
        """
        try:
            (begin or self.begin)()
            yield
        except BaseException:
            # all is told to stop before anything is waited for
            self.arm.try_to_stop()
            # the first fault is the one to report, not what it makes of the shutdown
            with contextlib.suppress(GonioError):
                self._leave(self.lamps.off, self.arm.stop, self.arm.release)
            raise
        self._leave(self.lamps.off, self.arm.release)

    def _leave(self, *steps: Callable[[], None]) -> None:
        """Take all steps, whatever fails on the way; raise the first failure."""
        failures = []
        self.troubles.leaving = True
        for step in steps:
            try:
                step()
            except GonioError as error:
                failures.append(error)
        self.troubles.leaving = False
        if failures:
            raise failures[0]
