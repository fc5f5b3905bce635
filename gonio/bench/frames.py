"""Frames of the white reference: what they take beside the exposure, and how bright they are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from gonio.bench.moves import spread_of
from gonio.errors import BadInputError
from gonio.geometry import ArmPose
from gonio.plan import LampSetting
from gonio.reduce.patch import PatchFinder
from gonio.reduce.raw import decode_raw
from gonio.timemodel import WHITE_POSE_DEG

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from gonio.capture import Instrument
    from gonio.rig import Rig
    from gonio.timing import Spread

REPEATS: Final = 4
"""Frames of each exposure, and how often the lamps and the whole start are tried."""

FULL_CURRENT_MA: Final = 700.0

_PATCH_MM = 5.0
_FAINTEST = 0.01


class FrameResult(NamedTuple):
    """What frames and lamps take, as in `gonio.timing.Timing`, and how bright white is."""

    startup: Spread
    lamps: Spread
    hold: Spread
    read_out: Spread
    white_level_s: float


class _Frame(NamedTuple):
    hold_s: float
    read_out_s: float
    white_level_s: float | None


def steps_of(rig: Rig) -> int:
    """Return how often `FrameBench` tells its progress."""
    return REPEATS * (len(rig.camera.exposures_s) + 2)


class FrameBench:
    """Exposes the white reference, which lies in the holder, at 0:45 under all lamps.

    Parameters
    ----------
    instrument, rig
        What exposes; enabled and homed.
    scratch
        An empty folder on the disk of the camera's folder.
    step
        Called after each step.
    """

    def __init__(
        self, instrument: Instrument, rig: Rig, scratch: Path, step: Callable[[], None]
    ) -> None:
        self._instrument, self._rig, self._scratch, self._step = instrument, rig, scratch, step
        self._lit = [LampSetting(n=lamp.n, mA=FULL_CURRENT_MA) for lamp in rig.lamps.lamp]

    def measure(self) -> FrameResult:
        """Measure start, lamps and frames.

        Raises
        ------
        gonio.errors.BadInputError
            When no exposure shows the white reference.
        gonio.errors.DeviceFaultError
            When a device fails.
        """
        self._instrument.move_clear(WHITE_POSE_DEG, self._rig)
        startup = self._repeated(self._start)
        lamps = self._repeated(lambda: self._instrument.lamps.apply(self._lit))
        frames = [
            self._expose(exposure_s, self._scratch / f"{number}_{repeat}.dng")
            for number, exposure_s in enumerate(self._rig.camera.exposures_s)
            for repeat in range(REPEATS)
        ]
        return FrameResult(
            startup=startup,
            lamps=lamps,
            hold=spread_of(np.array([frame.hold_s for frame in frames])),
            read_out=spread_of(np.array([frame.read_out_s for frame in frames])),
            white_level_s=_middle([frame.white_level_s for frame in frames]),
        )

    def _repeated(self, action: Callable[[], None]) -> Spread:
        clock, times_s = self._instrument.clock, []
        for _ in range(REPEATS):
            began = clock.now()
            action()
            times_s.append(clock.now() - began)
            self._step()
        return spread_of(np.array(times_s))

    def _start(self) -> None:
        """Do what a capture does once, homing apart."""
        self._instrument.lamps.identify()
        self._instrument.camera.prepare()
        self._instrument.arm.enable()
        self._instrument.lamps.off()
        self._instrument.lamps.apply(self._lit)

    def _expose(self, exposure_s: float, path: Path) -> _Frame:
        instrument, clock = self._instrument, self._instrument.clock
        began = clock.now()
        angles_deg = instrument.arm.angles_deg()
        latent = instrument.camera.expose(exposure_s)
        closed = clock.now()
        instrument.camera.fetch(latent, path)
        there = clock.now()
        view = ArmPose.from_degrees(angles_deg["view_theta"], angles_deg["view_phi"])
        level_s = self._white_level(path, view, latent.flux)
        self._step()
        return _Frame(max(closed - began - exposure_s, 0.0), there - closed, level_s)

    def _white_level(self, path: Path, view: ArmPose, flux: Sequence[float]) -> float | None:
        """Return the exposure that would just fill the range; None of a full or a dark frame."""
        raw = decode_raw(path.read_bytes(), path, "compare the camera with the rig file")
        patch = PatchFinder(self._rig.camera, _PATCH_MM).find(view, raw.sensor)
        pixels = patch.of(raw.mosaic)
        share = patch.mean(pixels - raw.sensor.black) / (raw.sensor.white - raw.sensor.black)
        if pixels.max() >= raw.sensor.saturation or share.max() < _FAINTEST:
            return None
        strength = float(np.mean([flux[lamp.n - 1] for lamp in self._lit]))
        return raw.exposure_s * strength / float(share.max())


def _middle(levels_s: Sequence[float | None]) -> float:
    known = [level for level in levels_s if level is not None]
    if not known:
        raise BadInputError(
            "the white reference is too bright or too dark at every exposure of the rig file; "
            "lay it in the holder, or add to camera.exposures_s one that shows it"
        )
    return float(np.median(known))
