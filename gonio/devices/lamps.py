"""The lamp head: eleven lamps, and the shutter of the camera that it triggers."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from gonio.devices.lamp_line import BUSY, GARBLED, REMEDIES, LampLine, LampRefusedError
from gonio.errors import BadInputError, DeviceFaultError, TransportTimeoutError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.clock import Clock
    from gonio.plan import LampSetting
    from gonio.rig import Rig
    from gonio.transports import SerialLine

LAMPS = 11

_BUSY_POLL_S = 0.1
_DONE_POLL_S = 0.02
_LONGEST_SILENCE_S = 10.0
# the shutter may take 1 % more than was asked for, and the head some time to say so
_EXPOSURE_SLACK, _EXPOSURE_SLACK_S = 1.01, 2.0
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
        self._clock = clock
        self._numbers = {lamp.n for lamp in rig.lamps.lamp}
        self._watchdog_ms = rig.lamps.watchdog_ms
        self._file_timeout_s = rig.camera.file_timeout_s
        self._lit: tuple[int, ...] = ()
        self._last_frame: int | None = None

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
        self._expect_ok("TRIG:ABRT")
        self._last_frame = self._status()[1]
        self._errors()
        self._expect_ok(f"SYST:WDOG {self._watchdog_ms}")
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
        self._lit = tuple(sorted(wanted))
        for n in range(1, LAMPS + 1):
            if n in wanted:
                current = f"{wanted[n].mA:.1f}"
                self._set(f"LED{n}:CURR", current, float(current))
            self._set(f"LED{n}:STAT", "ON" if n in wanted else "OFF", float(n in wanted))

    def off(self) -> None:
        """Switch every lamp off (errors as for `apply`)."""
        self._expect_ok("ALL:OFF")
        self.apply(())

    def expose(self, exposure_s: float) -> Exposure:
        """Open the shutter for `exposure_s` and wait until it has closed.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When the shutter does not open or close, or a lamp went out meanwhile.
        """
        frame = self._open_shutter(round(exposure_s * 1e6))
        flux = self._wait_done(frame, exposure_s)
        self._check_light(frame)
        return Exposure(frame, flux)

    def _open_shutter(self, exposure_us: int) -> int:
        """Return the number of the frame whose exposure has begun."""
        deadline_s = self._clock.now() + self._file_timeout_s
        while True:
            frame = self._try_shutter(exposure_us, is_last=self._clock.now() >= deadline_s)
            if frame is not None:
                self._last_frame = frame
                return frame
            self._clock.sleep(_BUSY_POLL_S)

    def _try_shutter(self, exposure_us: int, *, is_last: bool) -> int | None:
        try:
            answer = self._line.ask_once(f"TRIG:EXP {exposure_us}")
        except TransportTimeoutError:
            # whether the shutter opened is not known; a second exposure would be another frame
            _, frame, _ = self._status()
            if frame is not None and frame != self._last_frame:
                return frame
            if is_last:
                raise
            return None
        except LampRefusedError as refused:
            if is_last or refused.code not in (BUSY, *GARBLED):
                raise
            return None
        return int(_number(answer.removeprefix("OK "), "TRIG:EXP"))

    def _wait_done(self, frame: int, exposure_s: float) -> tuple[float, ...]:
        """Return the lamps' mean flux once the exposure is over."""
        closes_s = self._clock.now() + exposure_s
        deadline_s = closes_s + (_EXPOSURE_SLACK - 1.0) * exposure_s + _EXPOSURE_SLACK_S
        # a head that hears nothing takes the host for dead and switches its lamps off
        silence_s = self._watchdog_ms / 3000.0 or _LONGEST_SILENCE_S
        while True:
            left_s = max(closes_s - self._clock.now(), _DONE_POLL_S)
            self._clock.sleep(min(left_s, silence_s))
            state, number, flux = self._status()
            if state == "DONE" and number == frame and len(flux) == LAMPS:
                return flux
            if state != "OPEN" or number != frame:
                raise DeviceFaultError(
                    f"lamps: frame {frame} was under way, and now the head says {state} "
                    f"{number or ''}; it may have restarted: check its supply, then resume"
                )
            if self._clock.now() >= deadline_s:
                raise DeviceFaultError(
                    f"lamps: the shutter was to close after {exposure_s:g} s and is still open; "
                    "check the shutter's cable, then resume"
                )

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

    def _status(self) -> tuple[str, int | None, tuple[float, ...]]:
        """Return the shutter's state, the frame's number and its fluxes, as far as there are."""
        state, *rest = self._line.ask("TRIG:STAT?").split(" ")
        number = int(_number(rest[0], "TRIG:STAT?")) if rest else None
        values = rest[1].split(",") if len(rest) > 1 else ()
        return state, number, tuple(_number(value, "TRIG:STAT?") for value in values)

    def _errors(self) -> list[int]:
        """Empty the head's queue of errors."""
        codes: list[int] = []
        while len(codes) < _MOST_ERRORS:
            code = int(_number(self._line.ask("SYST:ERR?").partition(",")[0], "SYST:ERR?"))
            if code == 0:
                break
            codes.append(code)
        return codes

    def _set(self, name: str, value: str, expected: float) -> None:
        """Set what is not yet as it should be, and read it back."""
        if self._read(name) == expected:
            return
        self._expect_ok(f"{name} {value}")
        kept = self._read(name)
        if kept != expected:
            raise DeviceFaultError(
                f"lamps: {name} is {kept:g} after it was set to {value}; "
                "check the head and that nothing else drives it"
            )

    def _read(self, name: str) -> float:
        return _number(self._line.ask(f"{name}?"), name)

    def _expect_ok(self, command: str) -> None:
        answer = self._line.ask(command)
        if answer != "OK":
            raise _unexpected(answer, command)


def _number(text: str, command: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise _unexpected(text, command) from None


def _unexpected(answer: str, command: str) -> DeviceFaultError:
    return DeviceFaultError(
        f"lamps: {answer!r} is no answer to {command}; check device and dialect in the rig file"
    )
