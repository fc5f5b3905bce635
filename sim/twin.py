"""The rig's twin: four drives, a lamp head, a tethered camera and a sample holder, on one clock."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from gonio.geometry import ArmPose
from gonio.rig import AXES
from sim.bus import TwinBus
from sim.control import BOOT_S
from sim.drive import Drive
from sim.lamp_head import LampHead
from sim.lamp_protocol import LampProtocol
from sim.line import TwinLine
from sim.tether import Scene, Tether
from sim.vibration import Vibration

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from gonio.clock import VirtualClock
    from gonio.rig import Axis, Rig
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
    ) -> None:
        random = np.random.default_rng(seed)
        self.holder: Holder = "sample"
        self._clock = clock
        self._used: Counter[str] = Counter()
        self._taken = taken or {}
        vibrations = {"view": Vibration(), "light": Vibration()}
        self.drives = {
            name: _powered_up(
                rig.axis[name], vibrations[name.partition("_")[0]], random, clock.now()
            )
            for name in AXES
        }
        self.tether = Tether(camera, folder, clock, random, rig.camera.file_timeout_s)
        self.lamps = LampHead(clock, self.tether, self._scene)
        self.line = TwinLine(LampProtocol(self.lamps), clock)
        self.bus = TwinBus(
            {rig.axis[name].unit: self.drives[name] for name in AXES},
            clock,
            self._advance_drives,
            answers_for_unknown=rig.arm.transport == "tcp",
        )

    def set_interlock(self, is_open: bool) -> None:
        """Open the door or press the emergency stop, or put it right again."""
        now = self._clock.now()
        self._advance_drives(now)
        for drive in self.drives.values():
            drive.control.set_interlock(is_open, now)
        self.lamps.set_interlock(is_open)

    def pose(self, arm: str) -> ArmPose:
        """Return where an arm, `"view"` or `"light"`, truly is now."""
        now = self._clock.now()
        self._advance_drives(now)
        theta, phi = (self.drives[f"{arm}_{part}"].axis for part in ("theta", "phi"))
        return ArmPose.from_degrees(theta.actual_deg(now), phi.actual_deg(now))

    def _advance_drives(self, now: float) -> None:
        for drive in self.drives.values():
            drive.control.advance(now)

    def _scene(self, exposure_us: int, lit: str) -> Scene:
        # nothing in the key tells when the frame was taken: routes do not change a frame's noise
        targets = ",".join(str(drive.target) for drive in self.drives.values())
        what = f"{self.holder}|{targets}|{exposure_us}|{lit}"
        self._used[what] += 1
        before = self._taken.get((bool(lit), exposure_us), 0) if self.holder == "reference" else 0
        number = self._used[what] + before
        return Scene(self.holder, self.pose("view"), self.pose("light"), f"{what}|{number}")


def _powered_up(axis: Axis, vibration: Vibration, random: np.random.Generator, now: float) -> Drive:
    """Return a drive that was switched on just long enough ago, somewhere in its travel."""
    low, high = sorted((axis.to_counts(axis.min_deg), axis.to_counts(axis.max_deg)))
    return Drive(axis, vibration, random.uniform(low, high), now - BOOT_S)
