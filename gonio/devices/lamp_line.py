"""Questions and answers with a lamp head that speaks `lamps-1`."""

from __future__ import annotations

import math
import re
from functools import reduce
from operator import xor
from typing import TYPE_CHECKING

from gonio.errors import DeviceFaultError, TransportTimeoutError

if TYPE_CHECKING:
    from gonio.clock import Clock
    from gonio.transports import SerialLine

BUSY = 500
GARBLED = (100, 101)
"""What the head says of a request that the line has spoiled; it did not carry it out."""

REMEDIES = {
    300: ("over-temperature", "let the lamp cool below 70 deg C and check its cooling"),
    301: ("open circuit", "check the lamp and its cable"),
    350: ("too many errors to keep", "look for noise on the line"),
    400: ("interlock open", "close the door or release the emergency stop"),
    500: ("camera busy", "check the camera and its tethering"),
}
"""Errors that a person can do something about."""

# the head answers within 200 ms
_TIMEOUT_S = 0.5
_ANSWER = re.compile(
    rb"(?:#(?P<number>\d{1,2}) )?(?P<text>.*?)(?:\*(?P<sum>[0-9A-F]{2}))?", re.DOTALL
)
_ERROR = re.compile(r'ERR (\d+),"(.*)"')


class LampRefusedError(DeviceFaultError):
    """The head answered a request with an error; it did not carry it out.

    Attributes
    ----------
    code
        The head's error code.
    """

    def __init__(self, command: str, code: int, text: str) -> None:
        words, remedy = REMEDIES.get(code, (text.lower(), "check the head's firmware"))
        super().__init__(f"lamps: {command} was refused ({code}, {words}); {remedy}, then resume")
        self.code = code


class LampLine:
    """Numbered and checksummed requests, one at a time.

    Parameters
    ----------
    line
        The serial line.
    clock
        To measure time on.
    """

    def __init__(self, line: SerialLine, clock: Clock) -> None:
        self._line = line
        self._clock = clock
        self._number = 0

    def ask(self, command: str) -> str:
        """Return the answer to a command that may be carried out twice.

        What is lost or spoiled on the line is sent once more.

        Raises
        ------
        LampRefusedError
            When the head answers with an error.
        gonio.errors.TransportTimeoutError
            When no answer comes.
        """
        try:
            return self.ask_once(command)
        except TransportTimeoutError:
            return self.ask_once(command)
        except LampRefusedError as refused:
            if refused.code not in GARBLED:
                raise
            return self.ask_once(command)

    def command(self, command: str) -> None:
        """Give a command that is answered with OK (errors as for `ask`)."""
        answer = self.ask(command)
        if answer != "OK":
            raise unexpected(answer, command)

    def ask_once(self, command: str) -> str:
        """Return the answer to a command that is sent only once (errors as for `ask`)."""
        self._number = (self._number + 1) % 100
        request = b"#%d %s" % (self._number, command.encode("ascii"))
        self._line.send(request + b"*%02X" % reduce(xor, request))
        text = self._answer()
        error = _ERROR.fullmatch(text)
        if error:
            raise LampRefusedError(command, int(error[1]), error[2])
        return text

    def _answer(self) -> str:
        """Return the answer to the open request, passing over late and spoiled ones."""
        deadline_s = self._clock.now() + _TIMEOUT_S
        while (left_s := deadline_s - self._clock.now()) > 0:
            text = self._own_text(self._line.receive(left_s))
            if text is not None:
                return text
        raise TransportTimeoutError(
            "lamps: what comes over the line is no answer; check device and dialect in the rig file"
        )

    def _own_text(self, answer: bytes) -> str | None:
        """Return what an answer says to the open request, or None when it is spoiled or old."""
        parts = _ANSWER.fullmatch(answer)
        if parts is None or not answer.isascii():
            return None
        checksum = parts["sum"]
        if checksum and int(checksum, 16) != reduce(xor, answer[:-3]):
            return None
        text: str = parts["text"].decode("ascii")
        number = None if parts["number"] is None else int(parts["number"])
        if _ERROR.fullmatch(text) and number is None:
            # a request may lose its number and its checksum on the way; then the error has none
            return text
        return text if number == self._number and checksum else None


def number(text: str, command: str) -> float:
    """Return the number that a head has answered to `command`.

    Raises
    ------
    gonio.errors.DeviceFaultError
        When it is none.
    """
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise unexpected(text, command)
    return value


def unexpected(answer: str, command: str) -> DeviceFaultError:
    """Return the error for an answer that makes no sense."""
    return DeviceFaultError(
        f"lamps: {answer!r} is no answer to {command}; check device and dialect in the rig file"
    )
