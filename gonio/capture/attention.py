"""Between two shots a capture looks whether somebody wishes it to pause or to stop."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.errors import DeviceFaultError
from gonio.wishes import wished

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from gonio.capture.instrument import Instrument
    from gonio.capture.lighting import Lighting
    from gonio.clock import Clock

_POLL_S = 0.5


class StopWishedError(KeyboardInterrupt):
    """Somebody who watches wants the capture to end, in the order in which Ctrl-C ends it."""


class Attention:
    """Heeds what is wished in a session's folder (see `gonio.wishes`).

    Parameters
    ----------
    root
        The folder.
    instrument, lighting
        What is held while the capture pauses: arms where they are, lamps off.
    note
        Told of the beginning and the end of a pause, and of the first fault in it.
    person
        The time of whoever watches, which passes on a twin, too.
    """

    def __init__(
        self,
        root: Path,
        instrument: Instrument,
        lighting: Lighting,
        note: Callable[..., None],
        person: Clock,
    ) -> None:
        self._root = root
        self._instrument = instrument
        self._lighting = lighting
        self._note = note
        self._person = person

    @property
    def is_wanted(self) -> bool:
        """Whether there is a wish."""
        return wished(self._root) is not None

    def heed(self) -> None:
        """Return when nothing stands against going on; lamps that were off warm up again then.

        What fails during a pause is put in order after it: nothing moves while somebody may stand
        at the rig.

        Raises
        ------
        StopWishedError
            When the capture is to end.
        gonio.errors.DeviceFaultError
            When a device failed meanwhile.
        """
        fault = self._pause() if wished(self._root) == "pause" else None
        if wished(self._root) == "stop":
            raise StopWishedError("as wished by gonio watch")
        if fault is not None:
            raise fault

    def _pause(self) -> DeviceFaultError | None:
        """Hold until that is no longer wished; return the first fault meanwhile."""
        self._note("paused")
        first: DeviceFaultError | None = None
        while wished(self._root) == "pause":
            fault = self._hold()
            if first is None and fault is not None:
                first = fault
                self._note("fault", what=str(fault), did="left until the pause ends")
        self._note("resumed")
        return first

    def _hold(self) -> DeviceFaultError | None:
        clock = self._instrument.clock
        since_s = clock.now()
        fault: DeviceFaultError | None = None
        # watchdogs of head and drives hear that the host lives, of one where the other is gone
        for attend in (self._lighting.off, self._instrument.arm.attend):
            try:
                attend()
            except DeviceFaultError as failed:
                fault = failed
        self._person.sleep(_POLL_S)
        # a twin's own time stands still otherwise; a rig's has passed
        clock.sleep(since_s + _POLL_S - clock.now())
        return fault
