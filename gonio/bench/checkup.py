"""A walk through every device of a rig: what is there, what it says, what to do about it."""

from __future__ import annotations

import shutil
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from gonio.devices import TetheredCamera
from gonio.devices.lamps import COOL_C
from gonio.errors import DeviceFaultError, GonioError
from gonio.plan import LampSetting
from gonio.rig import AXES
from gonio.timemodel import frame_bytes
from gonio.words import size

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from gonio.capture import Instrument
    from gonio.rig import Rig

_FAINT_MA = 70.0
_FEW_FRAMES = 100
_LOW_BATTERY = 30


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at.

    Attributes
    ----------
    device, what
        Which device, and what of it.
    found
        What it says, or what is wrong.
    remedy
        What to do about it; empty where all is well.
    """

    device: str
    what: str
    found: str
    remedy: str = ""

    @property
    def is_well(self) -> bool:
        """Whether there is nothing to do."""
        return not self.remedy


def look_over(instrument: Instrument, rig: Rig) -> Iterator[Finding]:
    """Look at everything without changing anything; one thing that fails hides no other."""
    for name in AXES:
        yield from _guarded(name, "drive", partial(_axis, instrument, rig, name))
    yield from _guarded("lamps", "head", lambda: _lamps(instrument, rig))
    camera = instrument.camera
    if isinstance(camera, TetheredCamera):
        yield from _guarded("camera", "body", lambda: _tethered(camera))
        yield from _guarded("camera", "exposures", lambda: _exposures(camera))
    else:
        yield from _guarded("camera", "folder", lambda: _camera(rig))


def exercise(instrument: Instrument, rig: Rig, scratch: Path) -> Iterator[Finding]:
    """Enable the drives where they stand, light each lamp faintly, take a dark frame.

    Parameters
    ----------
    instrument, rig
        The rig.
    scratch
        An empty folder.
    """
    yield from _guarded("arm", "enabling", lambda: _enabled(instrument))
    yield from _guarded("lamps", "greeting", lambda: _greeted(instrument))
    for lamp in rig.lamps.lamp:
        yield from _guarded(f"lamp {lamp.n}", "light", partial(_lit, instrument, lamp.n))
    yield from _guarded("lamps", "dark", lambda: _dark(instrument))
    yield from _guarded("camera", "dark frame", lambda: _dark_frame(instrument, rig, scratch))


def _guarded(device: str, what: str, look: Callable[[], Iterator[Finding]]) -> Iterator[Finding]:
    try:
        found = list(look())
    except GonioError as error:
        problem, _, remedy = str(error).removeprefix(f"{device}: ").partition("; ")
        found = [Finding("", what, problem, remedy.removesuffix(", then resume") or "see above")]
    for each in found:
        yield replace(each, device=device)


def _axis(instrument: Instrument, rig: Rig, name: str) -> Iterator[Finding]:
    says, spec = instrument.arm.says(name), rig.axis[name]
    yield Finding("", "drive", f"{says.state}, {says.cause}", says.remedy)
    travel = f"{spec.min_deg:g} to {spec.max_deg:g}"
    inside = spec.min_deg <= says.degrees <= spec.max_deg
    # a drive that was just switched on counts from where it stands
    place = f"within {travel}" if inside else f"beyond {travel}: not homed, or zero_counts is wrong"
    yield Finding("", "encoder", f"{says.degrees:.2f} deg, {place}")


def _lamps(instrument: Instrument, rig: Rig) -> Iterator[Finding]:
    who = instrument.lamps.who()
    yield Finding("", "head", f"{who.maker} {who.model}, firmware {who.firmware}")
    says = {lamp.n: instrument.lamps.says(lamp.n) for lamp in rig.lamps.lamp}
    n, hottest = max(says.items(), key=lambda item: item[1].temperature_c)
    remedy = "" if hottest.temperature_c < COOL_C else "let it cool down, and check its cooling"
    yield Finding("", "temperature", f"{hottest.temperature_c:.1f} deg C at most, lamp {n}", remedy)
    lit = [n for n, each in says.items() if each.is_lit]
    # whoever looks holds the rig, so nobody measures with them
    remedy = "nobody needs them now; switch them off with: gonio rig stop" if lit else ""
    yield Finding("", "lit", ", ".join(map(str, lit)) or "none", remedy)


def _camera(rig: Rig) -> Iterator[Finding]:
    folder = Path(rig.camera.folder)
    if not folder.is_dir():
        raise DeviceFaultError(
            f"{folder} is no folder; start the camera's tethering, or correct camera.folder in "
            "the rig file"
        )
    left = len(list(folder.glob("frame_*.dng")))
    yield Finding("", "folder", f"{folder}, {left} frames of before" if left else str(folder))
    free, need = shutil.disk_usage(folder).free, _FEW_FRAMES * frame_bytes(rig)
    remedy = "" if free > need else "free some space"
    yield Finding("", "disk", f"{size(free)} free, {size(frame_bytes(rig))} a frame", remedy)


def _tethered(camera: TetheredCamera) -> Iterator[Finding]:
    who = camera.who()
    body = f"{who.maker} {who.model}, serial {who.serial}, firmware {who.firmware}"
    yield Finding("", "body", body)
    charge = who.battery.removesuffix("%")
    is_low = charge.isdecimal() and int(charge) < _LOW_BATTERY
    remedy = "charge it, or use a mains adapter" if is_low else ""
    yield Finding("", "battery", who.battery, remedy)
    for name, value in camera.wrong().items():
        # a capture sets it, if the camera lets it
        yield Finding("", "setting", f"{name} is {value}, and will be set")


def _exposures(camera: TetheredCamera) -> Iterator[Finding]:
    camera.check_exposures()
    yield Finding("", "exposures", "the camera has all of the rig file")


def _enabled(instrument: Instrument) -> Iterator[Finding]:
    instrument.arm.enable()
    instrument.arm.release()
    yield Finding("", "enabling", "all four, and let go again")


def _greeted(instrument: Instrument) -> Iterator[Finding]:
    instrument.lamps.identify()
    yield Finding("", "greeting", "answers, its watchdog is set")


def _lit(instrument: Instrument, n: int) -> Iterator[Finding]:
    instrument.lamps.apply([LampSetting(n=n, mA=_FAINT_MA)])
    flux = instrument.lamps.says(n).flux
    remedy = "" if flux > 0 else "check its monitor photodiode"
    yield Finding("", "light", f"flux {flux:.5f} at {_FAINT_MA:g} mA", remedy)


def _dark_frame(instrument: Instrument, rig: Rig, scratch: Path) -> Iterator[Finding]:
    instrument.camera.prepare()
    latent = instrument.camera.expose(rig.camera.exposures_s[0])
    path = scratch / "dark.dng"
    instrument.camera.fetch(latent, path)
    yield Finding("", "dark frame", f"number {latent.number}, {size(path.stat().st_size)}, whole")


def _dark(instrument: Instrument) -> Iterator[Finding]:
    instrument.lamps.off()
    yield Finding("", "dark", "all off")
