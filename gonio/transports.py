"""The seam between drivers and whatever answers them: hardware, or the twin.

A fault injector wraps any of these; a driver never knows which it has.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


class RegisterBus(Protocol):
    """Holding registers behind Modbus unit ids (functions 3, 6 and 16)."""

    def read(self, unit: int, address: int, count: int) -> list[int]:
        """Read `count` 16-bit registers from `address`.

        Raises
        ------
        gonio.errors.RegisterError
            When the unit answers with an exception.
        gonio.errors.TransportTimeoutError
            When no answer comes.
        """

    def write(self, unit: int, address: int, values: Sequence[int]) -> None:
        """Write 16-bit registers from `address`, all or none (errors as for `read`)."""

    def close(self) -> None:
        """Let go of the bus."""


class SerialLine(Protocol):
    """Lines of ASCII to and from one device."""

    def send(self, line: bytes) -> None:
        """Send one line; the line ending is added."""

    def receive(self, timeout_s: float) -> bytes:
        """Return the next line without its ending.

        Raises
        ------
        gonio.errors.TransportTimeoutError
            When none comes within `timeout_s`.
        """

    def close(self) -> None:
        """Let go of the port."""


class FrameFolder(Protocol):
    """Where a tethered camera leaves its files."""

    def names(self) -> set[str]:
        """Return the names of the whole frames that are there now."""

    def take(self, name: str, target: Path) -> None:
        """Move a frame out to `target`, synced to the disk."""

    def set_aside(self) -> int:
        """Move away whatever lies there from an earlier run; return how many files."""
