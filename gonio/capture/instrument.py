"""The devices that a capture drives, and the person who changes the sample."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

from gonio.errors import GonioError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.clock import Clock
    from gonio.devices import Arm, FolderCamera, LampHead

Holder = Literal["reference", "sample"]


class Operator(Protocol):
    """Whoever lays the white reference or the sample under the camera."""

    def place(self, what: Holder) -> None:
        """Return when `what` lies in the holder."""


@dataclass(frozen=True)
class Instrument:
    """Arm, lamps and camera on one clock."""

    arm: Arm
    lamps: LampHead
    camera: FolderCamera
    clock: Clock

    @contextlib.contextmanager
    def ready(self) -> Iterator[None]:
        """Enable and home everything; leave axes disabled and lamps off, whatever happens."""
        try:
            self.lamps.identify()
            self.camera.prepare()
            self.arm.enable()
            self.arm.home()
            yield
        except BaseException:
            # the first fault is the one to report, not what it makes of the shutdown
            with contextlib.suppress(GonioError):
                self.arm.stop()
            self._leave(quietly=True)
            raise
        self._leave(quietly=False)

    def _leave(self, *, quietly: bool) -> None:
        for shut in (self.lamps.off, self.arm.release):
            with contextlib.suppress(*([GonioError] if quietly else [])):
                shut()
