"""Between two shots a capture looks whether somebody wishes it to pause or to stop."""

from __future__ import annotations

import contextlib
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
        Told of the beginning and the end of a pause.
    person
        The time of whoever watches, which passes on a twin, too.
    """

    def __init__(
        self,
        root: Path,
        instrument: Instrument,
        lighting: Lighting,
        note: Callable[[str], None],
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

        Raises
        ------
        StopWishedError
            When the capture is to end.
        gonio.errors.DeviceFaultError
            The last of a device that failed meanwhile, once the pause is over: what puts it in
            order moves arms.
        """
        fault = self._paused() if wished(self._root) == "pause" else None
        if wished(self._root) == "stop":
            raise StopWishedError("as wished by gonio watch")
        if fault is not None:
            raise fault

    def _paused(self) -> DeviceFaultError | None:
        """Hold as long as a pause is wished; return the last fault of that time."""
        last = None
        self._note("paused")
        while wished(self._root) == "pause":
            last = self._hold() or last
        self._note("resumed")
        return last

    def _hold(self) -> DeviceFaultError | None:
        clock, last = self._instrument.clock, None
        since_s = clock.now()
        # watchdogs of head and drives hear that the host lives, each whatever the other does
        for attend in (self._lighting.off, self._instrument.arm.attend):
            try:
                attend()
            except DeviceFaultError as fault:
                last = fault
        self._person.sleep(_POLL_S)
        with contextlib.suppress(DeviceFaultError):  # the clock attends to the drives, too
            # a twin's own time stands still otherwise; a rig's has passed
            clock.sleep(since_s + _POLL_S - clock.now())
        return last
