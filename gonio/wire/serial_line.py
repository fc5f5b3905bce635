"""A serial line by pyserial."""

from __future__ import annotations

import os
import time
from typing import Any

from gonio.errors import TransportLostError, TransportTimeoutError

_BAUD = 115200
# no answer is nearly so long: what runs on without an end is no line
_LONGEST = 4096


class PortLine:
    """A `gonio.transports.SerialLine` at a real port, opened when it is first used.

    A port that went away is opened anew at the next line.

    Parameters
    ----------
    device
        The port, such as /dev/ttyUSB0.
    """

    def __init__(self, device: str) -> None:
        self._device = device
        self._port: Any = None
        self._begun = b""

    def send(self, line: bytes) -> None:
        """Send a line (see `gonio.transports.SerialLine`)."""
        port = self._opened()
        try:
            port.write(line + b"\n")
        except OSError as error:
            raise self._gone(error) from None

    def receive(self, timeout_s: float) -> bytes:
        """Return the next line (see `gonio.transports.SerialLine`)."""
        port, until_s = self._opened(), time.monotonic() + timeout_s
        try:
            while b"\n" not in self._begun:
                port.timeout = max(until_s - time.monotonic(), 0.0)
                came = port.read(max(port.in_waiting, 1))
                self._begun = (self._begun + came)[-_LONGEST:]
                if b"\n" not in came and time.monotonic() >= until_s:
                    raise TransportTimeoutError(
                        f"lamps: no answer within {timeout_s:.3g} s; check cable and device in the "
                        "rig file"
                    )
        except OSError as error:
            raise self._gone(error) from None
        line, _, self._begun = self._begun.partition(b"\n")
        return line.rstrip(b"\r")

    def close(self) -> None:
        """Let go of the port."""
        if self._port is not None:
            self._port.close()
            self._port = None

    def _opened(self) -> Any:
        import termios

        import serial

        if self._port is None:
            try:
                # whatever came before is thrown away on opening
                self._port = serial.Serial(
                    self._device, _BAUD, timeout=0, write_timeout=1.0, exclusive=True
                )
            except (OSError, ValueError, termios.error) as error:
                raise self._gone(error) from None
            self._begun = b""
        return self._port

    def _gone(self, error: Exception) -> TransportLostError:
        self.close()
        number = getattr(error, "errno", None)
        reason = os.strerror(number) if number else str(error).partition(":")[0]
        return TransportLostError(
            f"lamps: {self._device} cannot be used ({reason}); plug it in, and check the device "
            "in the rig file and its permissions"
        )
