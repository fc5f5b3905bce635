"""Going on after a fault: put the rig in order, do it again, and know when to give up."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from gonio.devices.waiting import wait_until
from gonio.errors import (
    DeviceFaultError,
    FrameLostError,
    GonioError,
    TransportLostError,
    TransportTimeoutError,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.capture.instrument import Instrument
    from gonio.capture.lighting import Lighting

TRIES = 3
"""How often something is tried before it is left for later."""

_FAULTS_IN_A_ROW = 8
_DOOR_TIMEOUT_S, _DOOR_POLL_S = 1800.0, 1.0


class _DoorStaysOpenError(DeviceFaultError):
    """Somebody has to come."""


class Recovery:
    """Does what may fail, again where that may help.

    Parameters
    ----------
    instrument, lighting
        What is put in order after a fault.
    note
        Told of each fault, and what is done about it.
    """

    def __init__(
        self, instrument: Instrument, lighting: Lighting, note: Callable[[str, str], None]
    ) -> None:
        self._instrument = instrument
        self._lighting = lighting
        self._note = note
        self._in_a_row = 0
        self._last: DeviceFaultError | None = None

    @property
    def last(self) -> DeviceFaultError | None:
        """The last fault, if there was any."""
        return self._last

    def progressed(self) -> None:
        """Note that something went well: what fails now is not all that fails."""
        self._in_a_row = 0

    def begin(self) -> None:
        """Make the rig ready; what fails is put in order.

        Not so where somebody has to come, who is still there: a device that does not answer, an
        open door.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When the rig cannot be put in order in three tries.
        """
        try:
            self._instrument.begin()
        except (TransportLostError, TransportTimeoutError):
            raise
        except DeviceFaultError as fault:
            if self._instrument.arm.interlock_is_open():
                raise
            self._meet(fault, "tried again")

    def attempt(self, action: Callable[[], None]) -> None:
        """Do something, up to three times until it goes well.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When the rig cannot be put in order in three tries, or eight faults came with nothing
            done between.
        """
        for left in reversed(range(TRIES)):
            try:
                action()
            except DeviceFaultError as fault:
                self._meet(fault, "tried again" if left else "left for later")
            else:
                return

    def _meet(self, fault: DeviceFaultError, did: str) -> None:
        self._count(fault, did)
        if isinstance(fault, FrameLostError):
            return
        for left in reversed(range(TRIES)):
            try:
                self._put_in_order()
            except _DoorStaysOpenError:
                raise
            except DeviceFaultError as another:
                # a door or a power cut may come at any time, so also now
                if not left:
                    raise
                self._count(another, "put in order again")
            else:
                return

    def _count(self, fault: DeviceFaultError, did: str) -> None:
        self._last = fault
        self._in_a_row += 1
        self._note(_told(fault), did)
        if self._in_a_row >= _FAULTS_IN_A_ROW:
            raise fault

    def _put_in_order(self) -> None:
        """Bring arm, lamps and camera to where a capture can go on.

        A door is waited for, faults are reset, lost positions are found again, and lamps that got
        too hot cool down.
        """
        with contextlib.suppress(GonioError):
            self._instrument.arm.stop()
        self._wait_for_the_door()
        self._instrument.begin()
        self._lighting.off()
        self._instrument.lamps.cool_down()

    def _wait_for_the_door(self) -> None:
        arm, clock = self._instrument.arm, self._instrument.clock
        if not arm.interlock_is_open():
            return
        self._note("the interlock is open: close the door or release the emergency stop", "waits")
        if not wait_until(
            clock, lambda: not arm.interlock_is_open(), _DOOR_TIMEOUT_S, _DOOR_POLL_S
        ):
            raise _DoorStaysOpenError(
                f"the interlock is open for {_DOOR_TIMEOUT_S / 60:g} min; close the door or "
                "release the emergency stop, then resume"
            )


def _told(fault: DeviceFaultError) -> str:
    return "; ".join([str(fault), *getattr(fault, "__notes__", [])])
