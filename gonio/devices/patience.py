"""Asking again: how often, after which failures, and what is told of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from gonio.errors import (
    DeviceFaultError,
    RegisterError,
    TransportLostError,
    TransportTimeoutError,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.clock import Clock
    from gonio.devices.troubles import Troubles

T = TypeVar("T")

TRIES = 4
"""How often a request is sent before its failure counts."""

_LAST_TRIES = 2

_BUSY = (0x05, 0x06)
# what a gateway says of a drive that has no power
_NO_SUCH_UNIT = 0x0B
_BUSY_PAUSE_S = 0.05
# who trips over a cable needs a while to see it
_PORT_TIMEOUT_S, _PORT_POLL_S = 60.0, 0.5


class Patience:
    """Carries out requests that may be carried out twice, some times over.

    Parameters
    ----------
    clock
        To wait on.
    troubles
        Told of each failure that is made good.
    may_repeat
        Whether what else a device answers is worth asking again.
    """

    def __init__(
        self,
        clock: Clock,
        troubles: Troubles,
        may_repeat: Callable[[DeviceFaultError], bool] = lambda _: False,
    ) -> None:
        self._clock = clock
        self._troubles = troubles
        self._may_repeat = may_repeat
        self._was_there = False
        self._back_by_s: float | None = None

    def ask(self, request: Callable[[], T]) -> T:
        """Return what the request returns at last.

        Raises
        ------
        gonio.errors.TransportTimeoutError
            When four requests are lost; two on leaving.
        gonio.errors.TransportLostError
            When the port is gone for a minute; at the second try on leaving.
        gonio.errors.DeviceFaultError
            What a device answers to the last request, or to any where asking again is no use.
        """
        failed = 0
        while True:
            try:
                answer = request()
            except DeviceFaultError as error:
                if self._may_come_back(error):
                    self._clock.sleep(_PORT_POLL_S)
                    continue
                failed += 1
                tries = _LAST_TRIES if self._troubles.leaving else TRIES
                if failed >= tries or not self._is_worth_it(error):
                    raise
                self._troubles.note(str(error), "asked again")
            else:
                self._was_there, self._back_by_s = True, None
                return answer

    def _may_come_back(self, error: DeviceFaultError) -> bool:
        """Return whether to wait for what is gone: not for what never was there, or stays away."""
        if not (_is_gone(error) and self._was_there) or self._troubles.leaving:
            return False
        if self._back_by_s is None:
            self._back_by_s = self._clock.now() + _PORT_TIMEOUT_S
            self._troubles.note(str(error), f"waits up to {_PORT_TIMEOUT_S:g} s")
        return self._clock.now() < self._back_by_s

    def _is_worth_it(self, error: DeviceFaultError) -> bool:
        if isinstance(error, RegisterError):
            if error.code in _BUSY:
                self._clock.sleep(_BUSY_PAUSE_S)
            return error.code in _BUSY
        if isinstance(error, TransportLostError):
            # a connection that broke meanwhile is made anew
            return self._troubles.leaving
        return isinstance(error, TransportTimeoutError) or self._may_repeat(error)


def _is_gone(error: DeviceFaultError) -> bool:
    if isinstance(error, RegisterError):
        return error.code == _NO_SUCH_UNIT
    return isinstance(error, TransportLostError)
