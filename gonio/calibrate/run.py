"""The whole calibration: dark frames, levels of white, stray light, flat field, lamps, dark."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.calibrate.dark import Stack, dark_before, dark_maps
from gonio.calibrate.exposing import Exposer
from gonio.calibrate.findings import Findings
from gonio.calibrate.lighting import FULL_CURRENT_MA, all_lamps, level_of, level_per_s, setting_for
from gonio.calibrate.scene import WhiteScene
from gonio.calibration import DarkSeries
from gonio.clearance import check_pose
from gonio.plan import LampSetting
from gonio.steps import Steps

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.calibrate.dark import DarkMaps
    from gonio.capture import Instrument, Operator
    from gonio.protocols import Progress
    from gonio.rig import Rig

DARK_FRAMES, LEVEL_FRAMES, FLAT_FRAMES, LAMP_FRAMES, STRAY_FRAMES = 8, 4, 6, 3, 4
"""Frames of each dark exposure, level, flat and lamp; of stray light, dark and lit."""

LEVELS: Final = (0.01, 0.02, 0.04, *(round(0.07 * n, 2) for n in range(1, 14)), 0.94, 1.15)
"""Shares of the range; the last overexposes."""

VIEWS_PHI_DEG: Final = (0.0, 22.5, 45.0, 67.5)
"""Turns of the camera about its axis: a square sample covers other pixels in each."""

_LIGHT_DEG = (45.0, 0.0)
# so steep that the camera sees the room above and below the board
_STEEP_DEG = (75.0, 180.0)
_FLAT_LEVEL = 0.5


def calibrate_rig(
    instrument: Instrument,
    operator: Operator,
    rig: Rig,
    folder: Path,
    progress: Progress | None = None,
) -> Findings:
    """Take the frames of a calibration and evaluate them.

    Everything is taken at 45:0, light at 45 deg and view along the normal (CIE 15), from where the
    white reference fills the most of the picture.

    Parameters
    ----------
    instrument, operator
        What to drive, and who lays the white reference under the camera.
    rig
        What it is said to be.
    folder
        Where frames go.
    progress
        Called with the number of frames done and of all.

    Raises
    ------
    gonio.errors.BadInputError
        When 45:0 is out of reach, or the white reference cannot be seen.
    gonio.errors.DeviceFaultError
        When a device fails.
    """
    for view_deg in (*((0.0, phi_deg) for phi_deg in VIEWS_PHI_DEG), _STEEP_DEG):
        check_pose([*view_deg, *_LIGHT_DEG], rig)
    exposures = len(rig.camera.exposures_s)
    total = (
        DARK_FRAMES * (exposures + 1) + exposures + LEVEL_FRAMES * len(LEVELS)
        + FLAT_FRAMES * len(VIEWS_PHI_DEG) + LAMP_FRAMES * len(rig.lamps.lamp) + 2 * STRAY_FRAMES
    )  # fmt: skip
    with instrument.ready():
        instrument.place(operator, "reference")
        steps = Steps(total, progress)
        return CalibrationRun(Exposer(instrument, rig, folder, steps), rig).measure()


class CalibrationRun:
    """One run; each part is evaluated before the next is taken, so that no frames pile up.

    Parameters
    ----------
    exposer
        Moves, lights and exposes.
    rig
        What it is said to be.
    """

    def __init__(self, exposer: Exposer, rig: Rig) -> None:
        self._exposer, self._rig = exposer, rig
        self._exposures_s = rig.camera.exposures_s
        self._series: list[DarkSeries] = []

    def measure(self) -> Findings:
        """Take all frames and return what they say (errors as `calibrate_rig`)."""
        exposer, rig = self._exposer, self._rig
        exposer.go((0.0, VIEWS_PHI_DEG[0]), _LIGHT_DEG)
        dark = self._dark()
        exposer.light(all_lamps(rig))
        probes = [exposer.take(s, 1, "probe")[0] for s in self._exposures_s]
        scene = WhiteScene(rig, probes[0])
        findings = Findings(rig, dark, scene, probes)
        per_s = level_per_s(probes, findings.patch, findings.end)
        self._levels(findings, per_s)
        self._stray(findings, per_s)
        self._flats(findings, per_s)
        self._lamps(findings, per_s)
        self._darken(self._exposures_s[-1])
        findings.finish(self._series)
        return findings

    def _levels(self, findings: Findings, per_s: float) -> None:
        # half the current is more than half the light: go by what the level before came to
        brighter = 1.0
        for level in LEVELS:
            exposure_s, current_mA = setting_for(level, brighter * per_s, self._exposures_s)
            self._exposer.light(all_lamps(self._rig, current_mA))
            frames = self._exposer.take(exposure_s, LEVEL_FRAMES, "level")
            findings.add_level(frames, current_mA)
            reached = level_of(frames[-1], findings.patch, findings.end)
            if reached:
                brighter = reached * FULL_CURRENT_MA / (per_s * exposure_s * current_mA)
        findings.fit_sensor()

    def _dark(self) -> DarkMaps:
        return dark_maps({s: self._darken(s) for s in self._exposures_s})

    def _darken(self, exposure_s: float) -> Stack:
        """Take dark frames of one exposure, and note how bright they are and when."""
        self._exposer.light(())
        stack, when, black = Stack(), [], 0
        for _ in range(DARK_FRAMES):
            (frame,) = self._exposer.take(exposure_s, 1, "dark")
            stack.add(frame.raw.mosaic)
            when.append(frame.since_start_s)
            black = frame.raw.sensor.black
        level = float(stack.mean.mean()) - black
        self._series.append(
            DarkSeries(
                exposure_s=exposure_s,
                since_start_s=float(np.mean(when)),
                level=level,
                frames=DARK_FRAMES,
            )
        )
        return stack

    def _stray(self, findings: Findings, per_s: float) -> None:
        self._exposer.go(_STEEP_DEG, _LIGHT_DEG)
        exposure_s, current_mA = setting_for(_FLAT_LEVEL, per_s, self._exposures_s)
        self._exposer.light(all_lamps(self._rig, current_mA))
        lit = self._exposer.take(exposure_s, STRAY_FRAMES, "stray")
        # at once, while the sensor is as warm as it was: lamps that warm up let it cool down
        self._exposer.light(())
        dark = self._exposer.take(exposure_s, STRAY_FRAMES, "dark")
        findings.add_stray(lit, dark_before(dark, lit))

    def _flats(self, findings: Findings, per_s: float) -> None:
        exposure_s, current_mA = setting_for(_FLAT_LEVEL, per_s, self._exposures_s)
        self._exposer.light(all_lamps(self._rig, current_mA))
        for phi_deg in VIEWS_PHI_DEG:
            self._exposer.go((0.0, phi_deg), _LIGHT_DEG)
            for _ in range(FLAT_FRAMES):
                findings.add_flat(self._exposer.take(exposure_s, 1, "flat")[0])

    def _lamps(self, findings: Findings, per_s: float) -> None:
        self._exposer.go((0.0, VIEWS_PHI_DEG[0]), _LIGHT_DEG)
        lamps = self._rig.lamps.lamp
        exposure_s, current_mA = setting_for(_FLAT_LEVEL, per_s / len(lamps), self._exposures_s)
        for lamp in lamps:
            self._exposer.light([LampSetting(n=lamp.n, mA=round(current_mA, 1))])
            findings.add_lamp(lamp.n, self._exposer.take(exposure_s, LAMP_FRAMES, "lamp"))
