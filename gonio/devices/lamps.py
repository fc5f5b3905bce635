"""The lamp head: eleven lamps, and the shutter of the camera that it triggers."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from gonio.devices.lamp_line import LampLine, number, unexpected
from gonio.devices.shutter import Shutter
from gonio.devices.troubles import Troubles
from gonio.devices.waiting import wait_until
from gonio.dialects import load_dialect
from gonio.errors import BadInputError, DeviceFaultError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.clock import Clock
    from gonio.plan import LampSetting
    from gonio.rig import Rig
    from gonio.transports import SerialLine

LAMPS = 11

_MOST_ERRORS = 40
COOL_C = 70.0
_COOLING_TIMEOUT_S, _COOLING_POLL_S = 900.0, 1.0


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


class LampStatus(NamedTuple):
    """What the head says of one lamp: its light by the monitor, 1 = 700 mA at 25 deg C."""

    is_lit: bool
    temperature_c: float
    flux: float


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
    troubles
        Told what the driver mended by itself.
    """

    def __init__(
        self, line: SerialLine, rig: Rig, clock: Clock, troubles: Troubles | None = None
    ) -> None:
        self._dialect = load_dialect(rig.lamps.dialect)
        self._line = LampLine(line, self._dialect, clock, troubles or Troubles())
        self._clock = clock
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
        identity = self.who()
        self._shutter.reset()
        self._errors()
        self._line.command(self._dialect.watchdog.format(ms=self._watchdog_ms))
        return identity

    def who(self) -> Identity:
        """Ask the head who it is, and change nothing (errors as for `identify`)."""
        answer = self._line.ask(self._dialect.identify)
        fields = answer.split(",")
        if len(fields) != len(Identity._fields):
            raise DeviceFaultError(
                f"lamps: {answer!r} is not how a lamp head introduces itself; "
                "check device and dialect in the rig file"
            )
        return Identity(*fields)

    def says(self, n: int) -> LampStatus:
        """Ask for the state of lamp `n`, and change nothing (errors as for `identify`)."""
        return LampStatus(
            is_lit=self._ask(self._dialect.is_on, n) == 1.0,
            temperature_c=self._ask(self._dialect.temperature, n),
            flux=self._ask(self._dialect.flux, n),
        )

    def shut(self) -> None:
        """Switch every lamp off by one request, and close the shutter (errors as for `apply`)."""
        self._line.command(self._dialect.all_off)
        self._line.command(self._dialect.abort)

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
        self._lit, dialect = tuple(sorted(wanted)), self._dialect
        for n in range(1, LAMPS + 1):
            if n in wanted:
                current = f"{wanted[n].mA:.1f}"
                setting = dialect.set_current.format(n=n, mA=current)
                self._set(dialect.current.format(n=n), setting, float(current))
            switch = dialect.switch_on if n in wanted else dialect.switch_off
            self._set(dialect.is_on.format(n=n), switch.format(n=n), float(n in wanted))

    def off(self) -> None:
        """Switch every lamp off (errors as for `apply`)."""
        self._line.command(self._dialect.all_off)
        self.apply(())

    def cool_down(self) -> None:
        """Wait until every lamp is cool enough to be lit again after it got too hot.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When one stays hot.
        """

        def are_cool() -> bool:
            return all(self._ask(self._dialect.temperature, n) < COOL_C for n in self._numbers)

        if not wait_until(self._clock, are_cool, _COOLING_TIMEOUT_S, _COOLING_POLL_S):
            raise DeviceFaultError(
                f"lamps: not below {COOL_C:g} deg C after {_COOLING_TIMEOUT_S:g} s in the dark; "
                "check their cooling, then resume"
            )

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
            raise unexpected(f"{len(flux)} fluxes", self._dialect.exposure)
        self.check_light(frame)
        return Exposure(frame, flux)

    def watch(self, duration_s: float) -> tuple[float, ...]:
        """Read every lamp's light from now on for so long, for a shutter that is not the head's.

        Returns
        -------
        tuple
            Mean of lamps 1 to 11, as `Exposure.flux`, from readings at the beginning, the end, and
            as often between as the head's watchdog asks for (errors as for `identify`).
        """
        until_s = self._clock.now() + duration_s
        readings = [self._fluxes()]
        while (left_s := until_s - self._clock.now()) > 0:
            self._clock.sleep(min(left_s, self._shutter.silence_s))
            readings.append(self._fluxes())
        return tuple(sum(lamp) / len(readings) for lamp in zip(*readings, strict=True))

    def _fluxes(self) -> tuple[float, ...]:
        return tuple(
            self._ask(self._dialect.flux, n) if n in self._lit else 0.0 for n in range(1, LAMPS + 1)
        )

    def check_light(self, frame: int) -> None:
        """Refuse a frame in which a lamp went out or the head queued an error.

        Raises
        ------
        gonio.errors.DeviceFaultError
            Saying which lamp, and why as far as the head tells.
        """
        passing = (self._dialect.busy, *self._dialect.garbled)
        codes = [code for code in self._errors() if code not in passing]
        out = [n for n in self._lit if self._ask(self._dialect.is_on, n) != 1.0]
        if not codes and not out:
            return
        known = self._dialect.errors.get(codes[0] if codes else 0)
        words, remedy = (
            (known.words, known.remedy) if known
            else ("no error queued", "check supply and watchdog_ms")
        )  # fmt: skip
        cause = f"{codes[0]}, {words}" if codes else words
        lamps = f"lamp {', '.join(map(str, out))} went out" if out else "the head had an error"
        raise DeviceFaultError(f"lamps: {lamps} in frame {frame} ({cause}); {remedy}, then resume")

    def _errors(self) -> list[int]:
        """Empty the head's queue of errors."""
        codes: list[int] = []
        question = self._dialect.next_error
        while len(codes) < _MOST_ERRORS:
            code = int(number(self._line.ask(question).partition(",")[0], question))
            if code == 0:
                break
            codes.append(code)
        return codes

    def _set(self, question: str, setting: str, expected: float) -> None:
        """Set what is not yet as it should be, and read it back."""
        if self._read(question) == expected:
            return
        self._line.command(setting)
        kept = self._read(question)
        if kept != expected:
            raise DeviceFaultError(
                f"lamps: {question} says {kept:g} after {setting}; check the head and that nothing "
                "else drives it"
            )

    def _ask(self, question: str, n: int) -> float:
        return self._read(question.format(n=n))

    def _read(self, question: str) -> float:
        return number(self._line.ask(question), question)
