"""The folder of a served twin: its rig file, its ports by name, its frames, its truth."""

from __future__ import annotations

import contextlib
import fcntl
import os
import socket
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomli_w

from gonio.errors import BadInputError, GonioError, StorageError
from gonio.files import write_bytes, write_json
from gonio.rig import load_rig
from gonio.validation import Document, check, parse_json, read_text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.rig import Rig

_REMEDY = "give another --folder"


class ServedNote(Document):
    """What a twin was served with last.

    Attributes
    ----------
    material
        As it was named.
    seed
        Of all noise.
    power_ups
        How often a twin was started in this folder before.
    """

    material: str
    seed: int
    power_ups: int


class ServedFolder:
    """Where a twin keeps what it gives; `root` is a whole path."""

    def __init__(self, root: Path) -> None:
        self.root = root.absolute()
        self.rig_path = self.root / "rig.toml"
        self.truth_path = self.root / "truth.npz"
        self.frames = self.root / "frames"
        self.lamps = self.root / "lamps"
        self.arm = self.root / "arm"
        self.control = self.root / "control"
        self._note_path = self.root / "twin.json"

    @contextlib.contextmanager
    def held(self) -> Iterator[None]:
        """Make the folder and hold it against other twins; the lock goes with the process.

        Raises
        ------
        gonio.errors.BadInputError
            When another twin is served there, or something else lives in it.
        gonio.errors.StorageError
            When it cannot be made.
        """
        if self.root.is_dir() and any(self.root.iterdir()) and not self._note_path.is_file():
            raise BadInputError(f"{self.root}: is no folder of a served twin; {_REMEDY}")
        try:
            self.frames.mkdir(parents=True, exist_ok=True)
            handle = os.open(self.root, os.O_RDONLY)
        except OSError as error:
            raise StorageError.from_os(self.root, error) from error
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield
        except BlockingIOError:
            raise BadInputError(
                f"{self.root}: another gonio sim serve runs there; stop it, or {_REMEDY}"
            ) from None
        finally:
            os.close(handle)

    def start(self, material: str, seed: int) -> int:
        """Note what is served; return how often a twin was started here before."""
        before = 0
        if self._note_path.is_file():
            data = parse_json(read_text(self._note_path, _REMEDY), self._note_path, _REMEDY)
            before = check(ServedNote, data, self._note_path, _REMEDY).power_ups + 1
        note = ServedNote(material=material, seed=seed, power_ups=before)
        write_json(self._note_path, note.model_dump())
        return before

    def last_port(self) -> int | None:
        """Return the TCP port of the last time, if it is free: a resume wants the same rig."""
        try:
            arm = load_rig(self.rig_path).arm
            with socket.socket() as probe:
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                probe.bind((arm.host, arm.port))
            return arm.port
        except (GonioError, OSError, TypeError):
            return None

    def write_rig(self, rig: Rig, port: int | None) -> None:
        """Write the rig file by which drivers find the twin.

        Parameters
        ----------
        rig
            What the twin is a twin of.
        port
            Of Modbus TCP; None for RTU.
        """
        data = rig.model_dump(mode="json", exclude_none=True)
        for key in ("transport", "host", "port", "device"):
            data["arm"].pop(key, None)
        data["arm"] = self._address(port) | data["arm"]
        data["lamps"]["device"] = str(self.lamps)
        data["camera"].pop("settings", None)
        data["camera"] |= {"kind": "folder", "folder": str(self.frames)}
        data["holder"] |= {"changer": "command", "changer_command": self._changer()}
        if isinstance(rig.holder.reference, str):
            data["holder"]["reference"] = str(Path(rig.holder.reference).absolute())
        text = "# of the twin that gonio sim serve runs; written anew each time\n\n"
        write_bytes(self.rig_path, (text + tomli_w.dumps(data)).encode())

    def _address(self, port: int | None) -> dict[str, Any]:
        if port is None:
            return {"transport": "rtu", "device": str(self.arm)}
        return {"transport": "tcp", "host": "127.0.0.1", "port": port}

    def _changer(self) -> list[str]:
        # this interpreter, since gonio need not be on the path of whoever captures
        program = [sys.executable, "-m", "gonio"]
        return [*program, "sim", "place", "{what}", "--at", str(self.root)]
