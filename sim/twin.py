"""The rig's twin: four drives, a lamp head, a tethered camera and a sample holder, on one clock."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from gonio.rig import AXES
from sim.bending import bent_deg, shake_rad
from sim.bus import TwinBus
from sim.control import BOOT_S
from sim.drive import Drive
from sim.fittings import fittings_of
from sim.imperfections import IDEAL, Imperfections
from sim.lamp_head import LampHead
from sim.lamp_protocol import LampProtocol
from sim.line import TwinLine
from sim.tether import Scene, Tether

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from gonio.clock import Clock, VirtualClock
    from gonio.geometry import ArmPose
    from gonio.rig import Axis, Rig
    from sim.fittings import Fittings
    from sim.tether import Camera, Holder


class Twin:
    """A rig that follows the protocol, in process.

    Everything is a function of the clock; nothing runs beside it.

    Parameters
    ----------
    rig
        What the twin is a twin of.
    camera
        Makes the files, such as `sim.camera.SimCamera`.
    clock
        The drivers' own.
    folder
        Where frames appear.
    seed
        Of where the arms stand at power-up and how long files take.
    taken
        How many frames of the reference were taken before power-up, by whether it was lit and by
        exposure in us: repeats of one scene go on with new noise.
    wires
        The clock on which bus and line take their time; the drivers' own unless they are real.
    imperfections
        Of its arms.

    Attributes
    ----------
    bus, line
        The transports to give to drivers.
    drives
        By the axis' name.
    lamps, tether
        Lamp head and camera.
    holder
        What lies in the sample holder, `"sample"` or `"reference"`; set it to change it.
    """

    def __init__(
        self,
        rig: Rig,
        camera: Camera,
        clock: VirtualClock,
        folder: Path,
        seed: int,
        taken: Mapping[tuple[bool, int], int] | None = None,
        wires: Clock | None = None,
        imperfections: Imperfections = IDEAL,
    ) -> None:
        random = np.random.default_rng(seed)
        self.holder: Holder = "sample"
        self._clock = clock
        self._used: Counter[str] = Counter()
        self._taken = taken or {}
        self._imperfections = imperfections
        self._fittings = fittings_of(rig, imperfections, seed)
        self.drives = {
            name: _powered_up(rig.axis[name], self._fittings[name], random, clock.now())
            for name in AXES
        }
        self.tether = Tether(camera, folder, clock, random, rig.camera.file_timeout_s)
        self.lamps = LampHead(clock, self.tether, self._scene)
        self.lamps.slow_down(imperfections.lamp_electronics_us)
        self.line = TwinLine(LampProtocol(self.lamps), wires or clock)
        self.bus = TwinBus(
            {rig.axis[name].unit: self.drives[name] for name in AXES},
            wires or clock,
            self.advance_drives,
            answers_for_unknown=rig.arm.transport == "tcp",
        )

    def set_interlock(self, is_open: bool) -> None:
        """Open the door or press the emergency stop, or put it right again."""
        now = self._clock.now()
        self.advance_drives(now)
        for drive in self.drives.values():
            drive.control.set_interlock(is_open, now)
        self.lamps.set_interlock(is_open)

    def pose(self, arm: str) -> ArmPose:
        """Return where an arm, `"view"` or `"light"`, truly is now."""
        now = self._clock.now()
        self.advance_drives(now)
        theta, phi = (self.drives[f"{arm}_{part}"].axis for part in ("theta", "phi"))
        angles = theta.actual_deg(now), phi.actual_deg(now)
        alignment = self._imperfections.alignment(arm)
        return alignment.pose(*bent_deg(*angles, now, self._imperfections))

    def set_power(self, is_on: bool) -> None:
        """Cut the drives' supply, or bring it back: they stop, and know no position then."""
        now = self._clock.now()
        self.advance_drives(now)
        for drive in self.drives.values():
            drive.power_up(now)
        self.bus.powered = is_on

    def hurry(self, times: float) -> None:
        """Be so many times faster than whoever feeds the watchdogs: they count that one's time."""
        for drive in self.drives.values():
            drive.control.hurry = times
        self.lamps.hurry = times

    def advance_drives(self, now: float) -> None:
        """Let everything happen at the drives that is due: both axes of an arm shake its end."""
        for drive in self.drives.values():
            drive.control.advance(now)

    def _scene(self, exposure_us: int, lit: str) -> Scene:
        # nothing in the key tells when the frame was taken: routes do not change a frame's noise
        targets = ",".join(str(drive.target) for drive in self.drives.values())
        what = f"{self.holder}|{targets}|{exposure_us}|{lit}"
        self._used[what] += 1
        before = self._taken.get((bool(lit), exposure_us), 0) if self.holder == "reference" else 0
        number = self._used[what] + before
        view = self.pose("view")
        shake = shake_rad(
            "view",
            view.theta,
            self._fittings["view_theta"].vibration,
            self._clock.now(),
            1e-6 * exposure_us,
        )
        return Scene(self.holder, view, self.pose("light"), f"{what}|{number}", shake)


def _powered_up(axis: Axis, fittings: Fittings, random: np.random.Generator, now: float) -> Drive:
    """Return a drive that was switched on just long enough ago, somewhere in its travel."""
    low, high = sorted((axis.to_counts(axis.min_deg), axis.to_counts(axis.max_deg)))
    return Drive(axis, fittings, random.uniform(low, high), now - BOOT_S)
