"""Questions and answers with a lamp head."""

from __future__ import annotations

import math
import re
from functools import reduce
from operator import xor
from typing import TYPE_CHECKING

from gonio.devices.patience import Patience
from gonio.errors import DeviceFaultError, TransportTimeoutError

if TYPE_CHECKING:
    from gonio.clock import Clock
    from gonio.devices.troubles import Troubles
    from gonio.dialects import Dialect
    from gonio.transports import SerialLine

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

    def __init__(self, command: str, code: int, text: str, dialect: Dialect) -> None:
        known = dialect.errors.get(code)
        words, remedy = (
            (known.words, known.remedy) if known else (text.lower(), "check the head's firmware")
        )
        super().__init__(f"lamps: {command} was refused ({code}, {words}); {remedy}, then resume")
        self.code = code


class LampLine:
    """Requests, one at a time, numbered and checksummed where the head's dialect has that.

    Parameters
    ----------
    line
        The serial line.
    dialect
        What the head understands.
    clock
        To measure time on.
    troubles
        Told what was asked again.
    """

    def __init__(
        self, line: SerialLine, dialect: Dialect, clock: Clock, troubles: Troubles
    ) -> None:
        self.dialect = dialect
        self._line = line
        self._clock = clock
        self._patience = Patience(clock, troubles, self._is_garbled)
        self._number = 0

    def ask(self, command: str) -> str:
        """Return the answer to a command that may be carried out twice.

        What is lost or spoiled on the line is sent again.

        Raises
        ------
        LampRefusedError
            When the head answers with an error.
        gonio.errors.TransportTimeoutError
            When no answer comes.
        gonio.errors.TransportLostError
            When the port is gone and stays so.
        """
        return self._patience.ask(lambda: self.ask_once(command))

    def command(self, command: str) -> None:
        """Give a command that is answered with OK (errors as for `ask`)."""
        answer = self.ask(command)
        if answer != "OK":
            raise unexpected(answer, command)

    def ask_once(self, command: str) -> str:
        """Return the answer to a command that is sent only once (errors as for `ask`)."""
        self._line.send(self._framed(command.encode("ascii")))
        text = self._answer()
        error = _ERROR.fullmatch(text)
        if error:
            raise LampRefusedError(command, int(error[1]), error[2], self.dialect)
        return text

    def _framed(self, command: bytes) -> bytes:
        if self.dialect.framing == "plain":
            return command
        self._number = (self._number + 1) % 100
        request = b"#%d %s" % (self._number, command)
        return request + b"*%02X" % reduce(xor, request)

    def _is_garbled(self, fault: DeviceFaultError) -> bool:
        return isinstance(fault, LampRefusedError) and fault.code in self.dialect.garbled

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
        if self.dialect.framing == "plain":
            return answer.decode("ascii") if answer.isascii() else None
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
