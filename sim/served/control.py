"""What a person does at a rig, done at a served twin: a local socket in its folder."""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from gonio.errors import BadInputError, DeviceFaultError

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from sim.tether import Holder
    from sim.twin import Twin

_ANSWER_S = 5.0
_MOST_BYTES = 200
_DONE = "done"


def acts(twin: Twin) -> dict[str, Callable[[], None]]:
    """Return what can be done at a twin, by its words."""

    def hold(what: Holder) -> None:
        twin.holder = what

    return {
        "place sample": lambda: hold("sample"),
        "place reference": lambda: hold("reference"),
        "door open": lambda: twin.set_interlock(True),
        "door closed": lambda: twin.set_interlock(False),
        "power off": lambda: twin.set_power(False),
        "power on": lambda: twin.set_power(True),
    }


@contextlib.asynccontextmanager
async def listening(path: Path, do: Callable[[str], None]) -> AsyncIterator[None]:
    """Listen at a path: `do` is given the words of each request.

    Raises
    ------
    KeyError
        By `do`, where it does not know the words.
    """

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        words = (await reader.read(_MOST_BYTES)).decode("utf-8", "replace")
        try:
            do(words)
            writer.write(_DONE.encode())
        except KeyError:
            writer.write(f"{words!r} is nothing that this twin does".encode())
        writer.close()

    with tempfile.TemporaryDirectory(prefix="gonio-sim-") as folder:
        # a socket's own name has to be short, so it lives elsewhere and the path is a link to it
        name = Path(folder) / "control"
        server = await asyncio.start_unix_server(serve, name)
        path.unlink(missing_ok=True)
        path.symlink_to(name)
        try:
            yield
        finally:
            server.close()
            path.unlink(missing_ok=True)


def tell(path: Path, words: str) -> None:
    """Have a served twin do something, and wait until it is done.

    Parameters
    ----------
    path
        Of its control.
    words
        What to do, such as `place reference`.

    Raises
    ------
    gonio.errors.BadInputError
        When no twin is served there.
    gonio.errors.DeviceFaultError
        When it does not do it.
    """
    with socket.socket(socket.AF_UNIX) as control:
        control.settimeout(_ANSWER_S)
        try:
            control.connect(os.path.realpath(path))
        except OSError:
            raise BadInputError(
                f"{path.parent}: no twin is served there; start it with gonio sim serve, or name "
                "its folder with --at"
            ) from None
        try:
            control.sendall(words.encode())
            answer = control.recv(_MOST_BYTES).decode("utf-8", "replace")
        except OSError as error:
            answer = f"no answer ({error})"
    if answer != _DONE:
        raise DeviceFaultError(f"{path.parent}: {answer or 'no answer'}; start it again")
