"""The lamp head: eleven lamps, and the shutter of the camera that it triggers."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from gonio.devices.lamp_line import BUSY, GARBLED, REMEDIES, LampLine, number, unexpected
from gonio.devices.shutter import Shutter
from gonio.errors import BadInputError, DeviceFaultError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.clock import Clock
    from gonio.plan import LampSetting
    from gonio.rig import Rig
    from gonio.transports import SerialLine

LAMPS = 11

_MOST_ERRORS = 40


class Identity(NamedTuple):
    """Who answers at the other end of the line."""

    maker: str
    model: str
    serial: str
    firmware: str


class Exposure(NamedTuple):
    """One frame that was exposed.

    Attributes
    ----------
    frame
        Its number, which is in the file's name.
    flux
        Mean of lamps 1 to 11 over the exposure, 1 = 700 mA at 25 deg C.
    """

    frame: int
    flux: tuple[float, ...]


class LampHead:
    """Sets lamps and reads back what it set; exposes frames and checks that the light stayed on.

    Parameters
    ----------
    line
        The serial line.
    rig
        Says which lamps there are, the watchdog and the camera's file timeout.
    clock
        To wait on.
    """

    def __init__(self, line: SerialLine, rig: Rig, clock: Clock) -> None:
        self._line = LampLine(line, clock)
        self._shutter = Shutter(self._line, rig, clock)
        self._numbers = {lamp.n for lamp in rig.lamps.lamp}
        self._watchdog_ms = rig.lamps.watchdog_ms
        self._lit: tuple[int, ...] = ()

    def identify(self) -> Identity:
        """Greet the head: close a shutter left open, forget old errors, set the watchdog.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When nobody answers, or not a lamp head.
        """
        answer = self._line.ask("*IDN?")
        fields = answer.split(",")
        if len(fields) != len(Identity._fields):
            raise DeviceFaultError(
                f"lamps: {answer!r} is not how a lamp head introduces itself; "
                "check device and dialect in the rig file"
            )
        self._shutter.reset()
        self._errors()
        self._line.command(f"SYST:WDOG {self._watchdog_ms}")
        return Identity(*fields)

    def apply(self, settings: Sequence[LampSetting]) -> None:
        """Light the lamps of `settings` at their currents, to 0.1 mA, and switch off the others.

        Raises
        ------
        gonio.errors.BadInputError
            For a lamp that the rig does not have.
        gonio.errors.DeviceFaultError
            When a lamp does not take what it is set to.
        """
        wanted = {setting.n: setting for setting in settings}
        if not wanted.keys() <= self._numbers:
            missing = min(wanted.keys() - self._numbers)
            raise BadInputError(
                f"lamp {missing} is not in the rig file; change the plan, or add the lamp"
            )
        # what went wrong before is over: every lamp is set and read back now
        self._errors()
        self._lit = tuple(sorted(wanted))
        for n in range(1, LAMPS + 1):
            if n in wanted:
                current = f"{wanted[n].mA:.1f}"
                self._set(f"LED{n}:CURR", current, float(current))
            self._set(f"LED{n}:STAT", "ON" if n in wanted else "OFF", float(n in wanted))

    def off(self) -> None:
        """Switch every lamp off (errors as for `apply`)."""
        self._line.command("ALL:OFF")
        self.apply(())

    def expose(self, exposure_s: float) -> Exposure:
        """Open the shutter for `exposure_s` and wait until it has closed.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When the shutter does not open or close, or a lamp went out meanwhile.
        """
        frame = self._shutter.open(exposure_s)
        flux = self._shutter.wait_closed(frame, exposure_s)
        if len(flux) != LAMPS:
            raise unexpected(f"{len(flux)} fluxes", "TRIG:STAT?")
        self._check_light(frame)
        return Exposure(frame, flux)

    def _check_light(self, frame: int) -> None:
        """Refuse a frame in which a lamp went out or the head queued an error."""
        codes = [code for code in self._errors() if code not in (BUSY, *GARBLED)]
        out = [n for n in self._lit if self._line.ask(f"LED{n}:STAT?") != "1"]
        if not codes and not out:
            return
        words, remedy = REMEDIES.get(
            codes[0] if codes else 0, ("no error queued", "check supply and watchdog_ms")
        )
        cause = f"{codes[0]}, {words}" if codes else words
        lamps = f"lamp {', '.join(map(str, out))} went out" if out else "the head had an error"
        raise DeviceFaultError(f"lamps: {lamps} in frame {frame} ({cause}); {remedy}, then resume")

    def _errors(self) -> list[int]:
        """Empty the head's queue of errors."""
        codes: list[int] = []
        while len(codes) < _MOST_ERRORS:
            code = int(number(self._line.ask("SYST:ERR?").partition(",")[0], "SYST:ERR?"))
            if code == 0:
                break
            codes.append(code)
        return codes

    def _set(self, name: str, value: str, expected: float) -> None:
        """Set what is not yet as it should be, and read it back."""
        if self._read(name) == expected:
            return
        self._line.command(f"{name} {value}")
        kept = self._read(name)
        if kept != expected:
            raise DeviceFaultError(
                f"lamps: {name} is {kept:g} after it was set to {value}; "
                "check the head and that nothing else drives it"
            )

    def _read(self, name: str) -> float:
        return number(self._line.ask(f"{name}?"), name)
