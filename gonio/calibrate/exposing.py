"""The frames of a calibration: exposed one by one, kept in its folder, read back at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.capture.lighting import Lighting
from gonio.errors import FrameLostError
from gonio.geometry import ArmPose
from gonio.reduce.raw import decode_raw

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from gonio.capture import Instrument
    from gonio.plan import LampSetting
    from gonio.reduce.raw import RawFrame
    from gonio.rig import Rig

_TRIES = 3
_REMEDY = "set the camera to DNG files alone, as docs/topics/cameras.md says, and calibrate again"


@dataclass(frozen=True)
class Exposed:
    """A frame and what was known when it was taken.

    Attributes
    ----------
    raw
        The frame.
    flux
        Of lamps 1 to 11.
    view, light
        Poses of the arms by the encoders.
    since_start_s
        When, since the first frame.
    """

    raw: RawFrame
    flux: tuple[float, ...]
    view: ArmPose
    light: ArmPose
    since_start_s: float


class Exposer:
    """Moves, lights and exposes for a calibration.

    Parameters
    ----------
    instrument, rig
        What to drive; enabled and homed.
    folder
        Where frames go.
    step
        Called after each frame.
    """

    def __init__(
        self, instrument: Instrument, rig: Rig, folder: Path, step: Callable[[], None]
    ) -> None:
        self._instrument, self._rig, self._folder, self._step = instrument, rig, folder, step
        self._lighting = Lighting(instrument.lamps, rig.lamps, instrument.clock)
        self._began_s = instrument.clock.now()
        self._number = 0

    def go(self, view_deg: tuple[float, float], light_deg: tuple[float, float]) -> None:
        """Move to (theta, phi) of view and light, in degrees."""
        names = ("view_theta", "view_phi", "light_theta", "light_phi")
        angles = dict(zip(names, (*view_deg, *light_deg), strict=True))
        self._instrument.move_clear(angles, self._rig)

    def light(self, settings: Sequence[LampSetting]) -> None:
        """Light some lamps, or none."""
        if settings:
            self._lighting.apply(settings)
        else:
            self._lighting.off()

    def take(self, exposure_s: float, repeats: int, name: str) -> list[Exposed]:
        """Expose frames of one kind.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When a device fails, or a frame is lost three times.
        gonio.errors.BadFileError
            When a file is no DNG that can be read.
        """
        return [self._one(exposure_s, name) for _ in range(repeats)]

    def _one(self, exposure_s: float, name: str) -> Exposed:
        path = self._folder / f"{self._number:04d}_{name}.dng"
        self._number += 1
        for tries_left in reversed(range(_TRIES)):
            try:
                return self._expose(exposure_s, path)
            except FrameLostError:
                if not tries_left:
                    raise
        raise AssertionError

    def _expose(self, exposure_s: float, path: Path) -> Exposed:
        clock, angles = self._instrument.clock, self._instrument.arm.angles_deg()
        since_start_s = clock.now() - self._began_s
        latent = self._instrument.camera.expose(exposure_s)
        self._instrument.camera.fetch(latent, path)
        raw = decode_raw(path.read_bytes(), path, _REMEDY)
        self._step()
        return Exposed(
            raw=raw,
            flux=latent.flux,
            view=ArmPose.from_degrees(angles["view_theta"], angles["view_phi"]),
            light=ArmPose.from_degrees(angles["light_theta"], angles["light_phi"]),
            since_start_s=since_start_s,
        )
