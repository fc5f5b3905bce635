"""The one error tree: what was wrong, where, and what to do, in one line."""

from __future__ import annotations

import errno
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from pathlib import Path


class GonioError(Exception):
    """Anything gonio reports to a person; `exit_code` is what the command line ends with."""

    exit_code = 2


class BadInputError(GonioError):
    """A value, option or direction that cannot be used."""


class BadFileError(BadInputError):
    """A file that is missing, foreign, broken or of another version.

    Parameters
    ----------
    path
        The file.
    problem
        What is wrong with it, and where inside.
    remedy
        What to do.
    """

    def __init__(self, path: Path | str, problem: str, remedy: str) -> None:
        super().__init__(f"{path}: {problem}; {remedy}")
        self.path = path


class NothingLeftError(BadInputError):
    """Every pair that the rig can take has been measured."""

    def __init__(self) -> None:
        super().__init__(
            "every pair that the rig can take has been measured; choose among other directions "
            "with --candidates"
        )


class MissingExtraError(GonioError):
    """A command needs a package of an extra that is not installed."""

    def __init__(self, package: str, extra: str) -> None:
        super().__init__(
            f"this needs {package}, which is not installed; run: pip install 'gonio[{extra}]'"
        )


class DeviceFaultError(GonioError):
    """A drive, lamp, camera or bus did not do what it was told."""

    exit_code = 3


class FrameLostError(DeviceFaultError):
    """The file of an exposure did not come, or is of no use; the rig itself is well."""


class TransportTimeoutError(DeviceFaultError):
    """A device did not answer in time; whether it acted is unknown."""


class TransportLostError(DeviceFaultError):
    """The port or connection to a device is gone; whether it acted is unknown."""


_BUSY: Final = "it is busy: see its manual"
_NOBODY: Final = "no drive answers there: switch it on, or correct its unit in the rig file"
_REMEDIES: Final = {5: _BUSY, 6: _BUSY, 0x0A: _NOBODY, 0x0B: _NOBODY}


class RegisterError(DeviceFaultError):
    """A drive answered a request with a Modbus exception; it did not act on it.

    Attributes
    ----------
    code
        The Modbus exception code (1 function, 2 address, 3 value, 0x0B no such unit).
    """

    def __init__(self, unit: int, address: int, code: int) -> None:
        remedy = _REMEDIES.get(code, "compare the rig file's profile with the drive's manual")
        super().__init__(
            f"unit {unit}, register 0x{address:04X}: the drive answered exception {code}; {remedy}"
        )
        self.code = code


class StorageError(GonioError):
    """A file could not be written: disk full, no permission, a folder in the way."""

    exit_code = 3

    @classmethod
    def from_os(cls, path: Path | str, error: OSError) -> StorageError:
        """Say in one line what the operating system refused for `path`."""
        if error.errno == errno.ENOSPC:
            return cls(f"{path}: the disk is full; free some space and run the command again")
        reason = error.strerror or str(error)
        return cls(f"{path}: cannot be written ({reason}); check the folder and its permissions")


class ResumeRefusedError(GonioError):
    """A session cannot be continued, since what it was made with differs from what is here."""

    exit_code = 4
