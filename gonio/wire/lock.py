"""A lock on a rig: who drives it drives it alone."""

from __future__ import annotations

import contextlib
import fcntl
import os
import socket
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from gonio.errors import BadInputError
from gonio.files import sha256_bytes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.rig import Rig


@contextlib.contextmanager
def hold_rig(rig: Rig) -> Iterator[None]:
    """Hold a rig's bus and its lamps' line against other processes; it goes with the process.

    The same ports are the same rig, whatever the rig file is called.

    Raises
    ------
    gonio.errors.BadInputError
        When another process holds one of them, naming it.
    """
    with contextlib.ExitStack() as held:
        for port in sorted({_bus(rig), _device(rig.lamps.device)}):
            held.enter_context(_held(port))
        yield


def _bus(rig: Rig) -> str:
    arm = rig.arm
    if arm.transport == "rtu":
        return _device(arm.device or "")
    return f"{_address(arm.host or '')}:{arm.port}"


def _address(host: str) -> str:
    # a name nobody knows fails where it is connected to
    with contextlib.suppress(OSError, UnicodeError):
        return socket.gethostbyname(host)
    return host


def _device(path: str) -> str:
    return os.path.realpath(path)


def holders(rig: Rig) -> list[int]:
    """Return the ids of the processes that hold a rig now, of those that said who they are."""
    found = set()
    for port in (_bus(rig), _device(rig.lamps.device)):
        with contextlib.suppress(OSError), _opened(port) as handle:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                found.add(_holder(handle))
    return sorted(int(process) for process in found if process.isdecimal())


@contextlib.contextmanager
def _opened(port: str) -> Iterator[int]:
    name = f"gonio-rig-{sha256_bytes(port.encode())[:16]}.lock"
    path = Path(tempfile.gettempdir()) / name
    flags = os.O_NOFOLLOW | os.O_CLOEXEC
    try:
        handle = os.open(path, os.O_RDWR | os.O_CREAT | flags, 0o644)
    except PermissionError:
        # another user's can be read, which is enough to hold it; fs.protected_regular bars O_CREAT
        handle = os.open(path, os.O_RDONLY | flags)
    try:
        yield handle
    finally:
        os.close(handle)


def _holder(handle: int) -> str:
    said = os.pread(handle, 32, 0).decode("ascii", "replace").strip()
    return said if said.isdecimal() and _may_hold(said, handle) else "unknown"


def _may_hold(process: str, handle: int) -> bool:
    """Return whether a process has the lock open: who could not write it left an older id there."""
    try:
        links = [*Path("/proc", process, "fd").iterdir()]
    except PermissionError:
        return True
    except OSError:
        return False
    return any(_leads_to(link, handle) for link in links)


def _leads_to(link: Path, handle: int) -> bool:
    with contextlib.suppress(OSError):
        return os.path.samestat(link.stat(), os.fstat(handle))
    return False


@contextlib.contextmanager
def _held(port: str) -> Iterator[None]:
    with _opened(port) as handle:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise BadInputError(
                f"{port}: another gonio drives this rig (process {_holder(handle)}); wait for it, "
                "or stop it with: gonio rig stop"
            ) from None
        with contextlib.suppress(OSError):
            os.ftruncate(handle, 0)
            os.pwrite(handle, f"{os.getpid()}\n".encode(), 0)
        yield
