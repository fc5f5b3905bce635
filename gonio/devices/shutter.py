"""The camera's shutter, which the lamp head triggers."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from gonio.devices.lamp_line import LampRefusedError, number
from gonio.errors import DeviceFaultError, TransportLostError, TransportTimeoutError

if TYPE_CHECKING:
    from gonio.clock import Clock
    from gonio.devices.lamp_line import LampLine
    from gonio.rig import Rig

_BUSY_POLL_S = 0.1
_DONE_POLL_S = 0.02
_LONGEST_SILENCE_S = 10.0
# the shutter may take 1 % more than was asked for, and the head some time to say so
_SLACK, _SLACK_S = 0.01, 2.0


class ShutterStatus(NamedTuple):
    """What the head says of the last exposure.

    Attributes
    ----------
    state
        `OPEN`, `DONE` or `IDLE`.
    frame
        Its number, or None when idle.
    flux
        Mean of each lamp over the exposure, when done.
    """

    state: str
    frame: int | None
    flux: tuple[float, ...]


class Shutter:
    """Opens the shutter once for each frame, and waits until it has closed.

    Parameters
    ----------
    line
        To the lamp head.
    rig
        Says the head's watchdog and the camera's file timeout.
    clock
        To wait on.

    Attributes
    ----------
    silence_s
        How long the head may be left unasked.
    """

    def __init__(self, line: LampLine, rig: Rig, clock: Clock) -> None:
        self._line = line
        self._dialect = line.dialect
        self._clock = clock
        self._file_timeout_s = rig.camera.file_timeout_s
        # a head that hears nothing takes the host for dead and switches its lamps off
        self.silence_s = rig.lamps.watchdog_ms / 3000.0 or _LONGEST_SILENCE_S
        self._last_frame: int | None = None

    def reset(self) -> None:
        """Close a shutter that an earlier run left open, and note which frame was the last."""
        self._line.command(self._dialect.abort)
        self._last_frame = self.status().frame

    def status(self) -> ShutterStatus:
        """Ask the head."""
        question = self._dialect.exposure
        state, *rest = self._line.ask(question).split(" ")
        frame = int(number(rest[0], question)) if rest else None
        values = rest[1].split(",") if len(rest) > 1 else ()
        return ShutterStatus(state, frame, tuple(number(value, question) for value in values))

    def open(self, exposure_s: float) -> int:
        """Open it and return the frame's number; while the camera is busy, ask again.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When it does not open, or the camera stays busy.
        """
        deadline_s = self._clock.now() + self._file_timeout_s
        while True:
            is_last = self._clock.now() >= deadline_s
            frame = self._try_to_open(round(exposure_s * 1e6), is_last=is_last)
            if frame is not None:
                self._last_frame = frame
                return frame
            self._clock.sleep(_BUSY_POLL_S)

    def wait_closed(self, frame: int, exposure_s: float) -> tuple[float, ...]:
        """Return the lamps' mean flux once the exposure is over.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When it does not close, or the head forgot the exposure.
        """
        closes_s = self._clock.now() + exposure_s
        deadline_s = closes_s + _SLACK * exposure_s + _SLACK_S
        while True:
            left_s = max(closes_s - self._clock.now(), _DONE_POLL_S)
            self._clock.sleep(min(left_s, self.silence_s))
            status = self.status()
            if status.frame != frame or status.state not in ("OPEN", "DONE"):
                raise DeviceFaultError(
                    f"lamps: frame {frame} was under way, and now the head says {status.state} "
                    f"{status.frame or ''}; it may have restarted: check its supply, then resume"
                )
            if status.state == "DONE":
                return status.flux
            if self._clock.now() >= deadline_s:
                raise DeviceFaultError(
                    f"lamps: the shutter was to close after {exposure_s:g} s and is still open; "
                    "check the shutter's cable, then resume"
                )

    def _try_to_open(self, exposure_us: int, *, is_last: bool) -> int | None:
        try:
            answer = self._line.ask_once(self._dialect.expose.format(us=exposure_us))
        except (TransportTimeoutError, TransportLostError):
            # whether it opened is not known; a second exposure would be another frame
            frame = self.status().frame
            if frame is not None and frame != self._last_frame:
                return frame
            if is_last:
                raise
            return None
        except LampRefusedError as refused:
            if is_last or refused.code not in (self._dialect.busy, *self._dialect.garbled):
                raise
            return None
        return int(number(answer.removeprefix("OK "), self._dialect.expose))
