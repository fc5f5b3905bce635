"""A rig's real devices, put together from its rig file, and whoever changes its sample."""

from __future__ import annotations

import contextlib
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.capture.instrument import Instrument
from gonio.clock import SystemClock
from gonio.devices import LocalFolder
from gonio.errors import BadInputError, DeviceFaultError
from gonio.wire import GPhotoPort, ModbusBus, PortLine, hold_rig

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.capture.instrument import Holder, Operator
    from gonio.rig import Rig
    from gonio.transports import CameraPort, FrameFolder

_CHANGER_TIMEOUT_S = 600.0


@contextlib.contextmanager
def connected(rig: Rig, start_s: float = 0.0) -> Iterator[Instrument]:
    """Connect to a rig's devices, and hold it against other processes.

    Parameters
    ----------
    rig
        The rig.
    start_s
        Where its clock begins: a resumed session goes on.

    Raises
    ------
    gonio.errors.BadInputError
        When another process drives it.
    """
    bus, line = ModbusBus(rig.arm), PortLine(rig.lamps.device)
    with hold_rig(rig), contextlib.closing(bus), contextlib.closing(line), _files(rig) as files:
        yield Instrument.of(bus, line, files, rig, SystemClock(start_s))


@contextlib.contextmanager
def _files(rig: Rig) -> Iterator[FrameFolder | CameraPort]:
    """Offer what a camera's files come by."""
    if rig.camera.kind == "folder":
        yield LocalFolder(Path(rig.camera.folder))
        return
    with contextlib.closing(GPhotoPort()) as port:
        yield port


@contextlib.contextmanager
def hardware(rig: Rig, start_s: float = 0.0) -> Iterator[tuple[Instrument, Operator]]:
    """Connect to a rig and to whoever changes its sample (see `connected`, `operator_of`)."""
    operator = operator_of(rig)
    with connected(rig, start_s) as instrument:
        yield instrument, operator


def operator_of(rig: Rig) -> Operator:
    """Return who lays reference and sample into a rig's holder.

    Raises
    ------
    gonio.errors.BadInputError
        When a person is to be asked, and there is no terminal to ask at.
    """
    if rig.holder.changer == "command":
        return CommandChanger(rig.holder.changer_command)
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        raise BadInputError(
            "somebody has to lay the white reference and the sample into the holder, and this is "
            "no terminal to ask at; run it at one, or set holder.changer_command in the rig file"
        )
    return Person()


class Person:
    """Asks at the terminal."""

    by_hand = True

    def place(self, what: Holder) -> None:
        """Return when somebody says that `what` lies in the holder."""
        name = "white reference" if what == "reference" else "sample"
        click.echo(f"\nLay the {name} into the holder, step back, then press Enter. ", err=True)
        try:
            input()
        except EOFError:
            raise KeyboardInterrupt from None


class CommandChanger:
    """Runs a command of the rig file that changes the sample."""

    # it takes longer than a drive's watchdog waits
    by_hand = True

    def __init__(self, command: tuple[str, ...]) -> None:
        self._command = command

    def place(self, what: Holder) -> None:
        """Return when the command has ended.

        Raises
        ------
        gonio.errors.DeviceFaultError
            When it cannot be run, fails, or takes more than ten minutes.
        """
        words = [word.replace("{what}", what) for word in self._command]
        try:
            ended = subprocess.run(
                words, timeout=_CHANGER_TIMEOUT_S, capture_output=True, text=True, check=False,
                stdin=subprocess.DEVNULL,
            )  # fmt: skip
        except (OSError, subprocess.TimeoutExpired) as error:
            raise self._failed(words, str(error)) from None
        if ended.returncode:
            said = " ".join((ended.stderr or ended.stdout).split())
            raise self._failed(words, said or f"exit code {ended.returncode}")

    def _failed(self, words: list[str], why: str) -> DeviceFaultError:
        return DeviceFaultError(
            f"holder: {' '.join(words)} failed ({why}); see to the changer, then resume"
        )
