"""What a camera is to a capture: it exposes, and later gives the file."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from pathlib import Path


class LatentFrame(NamedTuple):
    """A frame whose shutter has closed, and whose file is not here yet.

    Attributes
    ----------
    number
        Which exposure it is, as head or driver count them.
    name
        By which its file will be known to the driver.
    exposure_s
        What was asked for.
    triggered_s
        When, by the driver's clock.
    flux
        Mean of lamps 1 to 11 over the exposure, 1 = 700 mA at 25 deg C.
    """

    number: int
    name: str
    exposure_s: float
    triggered_s: float
    flux: tuple[float, ...]


class Camera(Protocol):
    """Takes a frame in two steps, between which the arms may move on.

    Attributes
    ----------
    sends
        Whether a file comes by itself, while something else is done; else `fetch` brings it.
    """

    sends: bool

    def prepare(self) -> int:
        """Make ready for a run; return how many files of before there are.

        Raises
        ------
        gonio.errors.BadInputError
            When it cannot do what the rig file says.
        gonio.errors.DeviceFaultError
            When it does not answer.
        """

    def expose(self, exposure_s: float) -> LatentFrame:
        """Open the shutter for `exposure_s` and wait until it has closed.

        Raises
        ------
        gonio.errors.FrameLostError
            When nothing comes of it.
        gonio.errors.DeviceFaultError
            When the shutter does not open or close, or a lamp went out meanwhile.
        """

    def has(self, frame: LatentFrame) -> bool:
        """Return whether `fetch` would neither wait nor take long: arms may be moving."""

    def fetch(self, frame: LatentFrame, target: Path) -> None:
        """Wait for a frame's file, bring it to `target`, synced, and check that it is the one.

        Raises
        ------
        gonio.errors.FrameLostError
            When no file comes in time, or a broken one, or one of another exposure.
        gonio.errors.StorageError
            When it cannot be written.
        """
