"""The one error tree: what was wrong, where, and what to do, in one line."""

from __future__ import annotations

import errno
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from pathlib import Path


class GonioError(Exception):
    """Anything gonio reports to a person.

    Attributes
    ----------
    exit_code
        What the command line ends with.
    advice
        What to do about any of its kind; the line itself says what to do about this one.
    """

    exit_code = 2
    advice = "Do what the end of the line says."


class BadInputError(GonioError):
    """A value, option or direction that cannot be used."""

    advice = "Correct what the line names; `--help` of the command tells what is allowed."


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

    advice = "Make the file again with the command that the line names, or put a copy of it back."

    def __init__(self, path: Path | str, problem: str, remedy: str) -> None:
        super().__init__(f"{path}: {problem}; {remedy}")
        self.path = path


class NothingLeftError(BadInputError):
    """Every pair that the rig can take has been measured."""

    advice = "Be content, or name other directions with `--candidates`."

    def __init__(self) -> None:
        super().__init__(
            "every pair that the rig can take has been measured; choose among other directions "
            "with --candidates"
        )


class MissingExtraError(GonioError):
    """A command needs a package of an extra that is not installed."""

    advice = "Install the extra that the line names: `pip install 'gonio[...]'`."

    def __init__(self, package: str, extra: str) -> None:
        super().__init__(
            f"this needs {package}, which is not installed; run: pip install 'gonio[{extra}]'"
        )


class DeviceFaultError(GonioError):
    """A drive, lamp, camera or bus did not do what it was told."""

    exit_code = 3
    advice = (
        "Look the rig over with `gonio rig check`, mend what it finds, and go on with "
        "`gonio capture --resume`."
    )


class FrameLostError(DeviceFaultError):
    """The file of an exposure did not come, or is of no use; the rig itself is well."""

    advice = (
        "Nothing of a single one, which a capture takes again. Of many, check the camera's card, "
        "cable and folder."
    )


class TransportTimeoutError(DeviceFaultError):
    """A device did not answer in time; whether it acted is unknown."""

    advice = (
        "Check the device's power, its cable, and its unit or port in the rig file; then "
        "`gonio rig check`."
    )


class TransportLostError(DeviceFaultError):
    """The port or connection to a device is gone; whether it acted is unknown."""

    advice = (
        "Plug it in again and see that no other program holds the port; then go on with "
        "`gonio capture --resume`."
    )


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

    advice = "Compare the rig file's profile and unit with the drive's manual."

    def __init__(self, unit: int, address: int, code: int) -> None:
        remedy = _REMEDIES.get(code, "compare the rig file's profile with the drive's manual")
        super().__init__(
            f"unit {unit}, register 0x{address:04X}: the drive answered exception {code}; {remedy}"
        )
        self.code = code


class StorageError(GonioError):
    """A file could not be written: disk full, no permission, a folder in the way."""

    exit_code = 3
    advice = "Free some space, or name a folder that can be written; then run the command again."

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
    advice = (
        "Go on as the session was begun, or put back what was changed; else measure anew into "
        "another folder with `-o`."
    )
