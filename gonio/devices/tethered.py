"""A camera at a cable, which is told to expose and then asked for its file."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from gonio.devices.camera import check_whole
from gonio.devices.frame_check import FrameCheck
from gonio.devices.latent import LatentFrame
from gonio.devices.patience import Patience
from gonio.devices.shutter_speeds import seconds_of, speed_for
from gonio.errors import BadInputError, DeviceFaultError, FrameLostError, TransportLostError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from gonio.clock import Clock
    from gonio.devices.lamps import LampHead
    from gonio.devices.troubles import Troubles
    from gonio.rig import Rig
    from gonio.transports import CameraPort

_SPEED = "shutterspeed"
_POLL_S = 0.02
_WHO = ("manufacturer", "cameramodel", "serialnumber", "deviceversion", "batterylevel")


class CameraStatus(NamedTuple):
    """What a camera says of itself; `unknown` where it does not."""

    maker: str
    model: str
    serial: str
    firmware: str
    battery: str


class TetheredCamera:
    """A `gonio.devices.Camera` that is triggered, and whose files are fetched, through its cable.

    A file counts when it is new on the camera since the trigger, whole, and that of its exposure;
    only then is it deleted there.

    Parameters
    ----------
    port
        The cable.
    lamps
        Watched while the shutter is open, which is not theirs.
    rig
        Says the camera's settings and exposures, and how long a file may take.
    clock
        To wait on.
    troubles
        Told of files that nobody waits for, and of what was asked again.
    """

    sends = False

    def __init__(
        self, port: CameraPort, lamps: LampHead, rig: Rig, clock: Clock, troubles: Troubles
    ) -> None:
        self._port, self._lamps, self._spec = port, lamps, rig.camera
        self._clock, self._troubles = clock, troubles
        self._patience = Patience(clock, troubles)
        self._check = FrameCheck()
        self._known: set[str] = set()
        self._speeds: list[str] = []
        self._exposed = 0
        self._is_behind = False

    def who(self) -> CameraStatus:
        """Ask the camera who it is, and change nothing (errors as for `prepare`)."""
        return CameraStatus(*map(self._said, _WHO))

    def wrong(self) -> Mapping[str, str]:
        """Return those settings of the rig file that the camera has otherwise, as it has them."""
        says = [(self._read(setting.name), setting) for setting in self._spec.settings]
        return {setting.name: value for value, setting in says if value != setting.value}

    def check_exposures(self) -> None:
        """Refuse exposures of the rig file that the camera does not have, and change nothing.

        Raises
        ------
        gonio.errors.BadInputError
            Naming the exposure, and the next ones that there are.
        """
        choices = self._choices()
        for exposure_s in self._spec.exposures_s:
            speed_for(exposure_s, choices)

    def prepare(self) -> int:
        """Make ready for a run (see `gonio.devices.Camera`): settings, and which files are old."""
        self._renew()
        for setting in self._spec.settings:
            self._set(setting.name, setting.value)
        self.check_exposures()
        return len(self._known)

    def expose(self, exposure_s: float) -> LatentFrame:
        """Open the shutter (see `gonio.devices.Camera`); it has closed when there is a file."""
        if self._is_behind:
            self._renew()
        self._set_speed(exposure_s)
        self._pass_over()
        self._exposed, began_s = self._exposed + 1, self._clock.now()
        # whether a trigger that failed was heard is not known: what comes of it is passed over
        self._is_behind = True
        self._port.trigger()
        flux = self._lamps.watch(exposure_s)
        name = self._wait_for_file(began_s + exposure_s)
        self._is_behind = False
        self._lamps.check_light(self._exposed)
        return LatentFrame(self._exposed, name, exposure_s, began_s, flux)

    def has(self, frame: LatentFrame) -> bool:
        """Return that it takes long: drives that move hear nothing while a cable is busy."""
        return False

    def fetch(self, frame: LatentFrame, target: Path) -> None:
        """Bring a frame's file (see `gonio.devices.Camera`), and delete it on the camera."""
        stated = self._patience.ask(lambda: self._port.download(frame.name, target))
        size = target.stat().st_size
        if size < stated:
            raise FrameLostError(
                f"camera: {frame.name}: {size} of {stated} bytes came; check its cable, then resume"
            )
        check_whole(target)
        self._check.admit(frame, target)
        self._delete(frame.name)

    def _renew(self) -> None:
        """Connect anew, which forgets what was under way, and take all files there for old."""
        self._patience.ask(self._port.connect)
        self._known = self._patience.ask(self._port.files)
        self._speeds, self._is_behind = [], False

    def _set_speed(self, exposure_s: float) -> None:
        """Set the shutter to an exposure, and read back how long it will be open."""
        speed = speed_for(exposure_s, self._choices())
        if self._read(_SPEED) == speed:
            return
        self._patience.ask(lambda: self._port.write(_SPEED, speed))
        kept = self._read(_SPEED)
        if seconds_of(kept) != seconds_of(speed):
            raise self._otherwise(_SPEED, speed, kept)

    def _set(self, name: str, value: str) -> None:
        """Set what is not yet as the rig file says, and read it back."""
        if self._read(name) == value:
            return
        choices = self._patience.ask(lambda: self._port.choices(name))
        if choices and value not in choices:
            raise BadInputError(
                f"camera: {name} cannot be {value!r}; in camera.settings use one of "
                f"{', '.join(choices)}"
            )
        self._patience.ask(lambda: self._port.write(name, value))
        kept = self._read(name)
        if kept != value:
            raise self._otherwise(name, value, kept)

    def _otherwise(self, name: str, value: str, kept: str) -> DeviceFaultError:
        return DeviceFaultError(
            f"camera: {name} says {kept} after it was set to {value}; turn its mode dial to M, and "
            "see that nothing else sets it"
        )

    def _pass_over(self) -> None:
        """Take note of files that came with nothing under way."""
        while (name := self._new_file()) is not None:
            self._troubles.note(f"camera: {name}: came late, or of no exposure here", "left there")

    def _wait_for_file(self, closes_s: float) -> str:
        until_s = closes_s + self._spec.file_timeout_s
        while (name := self._new_file()) is None:
            if self._clock.now() >= until_s:
                raise FrameLostError(
                    f"camera: frame {self._exposed} did not come within "
                    f"{self._spec.file_timeout_s:g} s after its exposure; check the camera's card, "
                    "focus (manual) and mode (M), then resume"
                )
            self._clock.sleep(_POLL_S)
        return name

    def _new_file(self) -> str | None:
        """Return a file that was not there before, if the camera tells of one."""
        name = self._patience.ask(lambda: self._port.new_file(_POLL_S))
        if name is None:
            return None
        if name in self._known:
            self._troubles.note(f"camera: {name}: was there before this exposure", "passed over")
            return None
        self._known.add(name)
        return name

    def _delete(self, name: str) -> None:
        try:
            self._patience.ask(lambda: self._port.delete(name))
        except DeviceFaultError as error:
            # it is here and whole, which is what counts
            self._troubles.note(str(error), "left there")

    def _choices(self) -> list[str]:
        # asked once a connection: a camera takes its time over it
        if not self._speeds:
            self._speeds = self._patience.ask(lambda: self._port.choices(_SPEED))
        return self._speeds

    def _read(self, name: str) -> str:
        return self._patience.ask(lambda: self._port.read(name))

    def _said(self, name: str) -> str:
        try:
            return self._read(name)
        except TransportLostError:
            raise
        except DeviceFaultError:
            return "unknown"
