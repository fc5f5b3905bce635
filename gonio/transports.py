"""The seam between drivers and whatever answers them: hardware, or the twin.

A fault injector wraps any of these; a driver never knows which it has.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, runtime_checkable

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


@runtime_checkable
class CameraPort(Protocol):
    """A camera at the end of a cable, which keeps its files until they are deleted there."""

    def connect(self) -> None:
        """Connect, or connect anew; every other request does so where there is no connection.

        Raises
        ------
        gonio.errors.TransportLostError
            When there is no camera, or somebody else holds it. Any request may raise it, and the
            next one then connects anew.
        gonio.errors.TransportTimeoutError
            When the camera does not answer. Any request may raise it.
        gonio.errors.DeviceFaultError
            When the camera refuses. Any request may raise it.
        """

    def read(self, name: str) -> str:
        """Return the value of a setting."""

    def write(self, name: str, value: str) -> None:
        """Change a setting; a camera may take another value than it is given."""

    def choices(self, name: str) -> list[str]:
        """Return the values that a setting may have; none where it is no choice."""

    def files(self) -> set[str]:
        """Return the whole paths of the files on the camera."""

    def trigger(self) -> None:
        """Take a picture, and wait for nothing."""

    def new_file(self, timeout_s: float) -> str | None:
        """Return the whole path of a file that the camera says it has made; None when it does not.

        It may come back earlier than after `timeout_s`.
        """

    def download(self, path: str, target: Path) -> int:
        """Write a file to `target`, whole or not at all; return how long the camera says it is.

        Raises
        ------
        gonio.errors.StorageError
            When it cannot be written.
        """

    def delete(self, path: str) -> None:
        """Delete a file on the camera."""

    def close(self) -> None:
        """Let go of the camera."""
